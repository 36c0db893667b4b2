// SPDX-License-Identifier: MIT
#include "host/bite_line/place/gap_bridge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace biteline::bite_line {

namespace {

std::size_t lever_steps(double station_mm) {
  return static_cast<std::size_t>(std::lround(geometry::k_end_lever_mm / station_mm));
}

/// Mean square of `off_mm(trial)` over gaps of the same length that lie, with `beside` on both sides, where
/// all is known.
template <class Off>
double tried_mm(std::span<const std::uint8_t> known, const geometry::Gap& gap, std::size_t beside,
                double station_mm, Off&& off_mm) {
  constexpr double k_stride_mm = 5.0;
  constexpr std::size_t k_fewest = 3;
  const std::size_t count = known.size();
  const std::size_t length = gap.steps + 2 * beside;
  const auto stride =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(k_stride_mm / station_mm)));
  if (length >= count) return 0;
  double sum = 0;
  std::size_t trials = 0;
  for (std::size_t from = 0; from < count; from += stride) {
    bool all_known = true;
    for (std::size_t k = 0; all_known && k <= length; ++k) all_known = known[(from + k) % count] != 0;
    if (!all_known) continue;
    const double off = off_mm(geometry::Gap{.first = (from + beside) % count, .steps = gap.steps});
    sum += off * off;
    ++trials;
  }
  return trials < k_fewest ? 0 : std::sqrt(sum / static_cast<double>(trials));
}

}  // namespace

bool firm_ends(std::span<const std::uint8_t> known, const geometry::Gap& gap, double station_mm) {
  const std::size_t count = known.size();
  for (std::size_t k = 0; k <= 2 * lever_steps(station_mm); ++k) {
    if (known[(gap.first + count - k % count) % count] == 0) return false;
    if (known[(gap.first + gap.steps + k) % count] == 0) return false;
  }
  return true;
}

geometry::Arc gap_arc(std::span<const Vec2> plan, const geometry::Gap& gap, double station_mm) {
  const std::size_t count = plan.size();
  const std::size_t lever = lever_steps(station_mm);
  const std::size_t end = (gap.first + gap.steps) % count;
  const auto level = [&](std::size_t at) { return Vec3{plan[at].x(), plan[at].y(), 0}; };
  const auto back = [&](std::size_t k) { return level((gap.first + count - k) % count); };
  const auto ahead = [&](std::size_t k) { return level((end + k) % count); };
  return {
      .p0 = back(0),
      .d0 = geometry::CurveEnd{.end = back(0), .near = back(lever), .far = back(2 * lever)}.direction(),
      .p1 = ahead(0),
      .d1 = -geometry::CurveEnd{.end = ahead(0), .near = ahead(lever), .far = ahead(2 * lever)}.direction()};
}

double tried_plan_mm(std::span<const Vec2> plan, std::span<const std::uint8_t> known,
                     const geometry::Gap& gap, double station_mm) {
  return tried_mm(known, gap, 2 * lever_steps(station_mm), station_mm, [&](const geometry::Gap& trial) {
    const Vec2 middle = gap_arc(plan, trial, station_mm).at(0.5).head<2>();
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k <= trial.steps; ++k)
      nearest = std::min(nearest, (plan[(trial.first + k) % plan.size()] - middle).norm());
    return nearest;
  });
}

double tried_height_mm(std::span<const double> z_mm, std::span<const std::uint8_t> known,
                       const geometry::Gap& gap, double station_mm) {
  const auto beside = static_cast<std::size_t>(std::lround(k_height_lever_mm / station_mm));
  return tried_mm(known, gap, beside, station_mm, [&](const geometry::Gap& trial) {
    // The stretch alone: its lever, the gap, the other lever.
    const std::size_t count = z_mm.size();
    std::vector<double> stretch;
    for (std::size_t k = 0; k <= trial.steps + 2 * beside; ++k)
      stretch.push_back(z_mm[(trial.first + count - beside + k) % count]);
    const std::size_t middle = beside + trial.steps / 2;
    const double truth = stretch[middle];
    std::vector<std::uint8_t> seen(stretch.size(), 1);
    std::fill_n(seen.begin() + static_cast<std::ptrdiff_t>(beside) + 1, trial.steps - 1, std::uint8_t{0});
    geometry::bridge_smooth(stretch, seen, station_mm, k_height_lever_mm);
    return stretch[middle] - truth;
  });
}

}  // namespace biteline::bite_line
