// SPDX-License-Identifier: MIT
#include "host/bite_line/place/gap_bridge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace biteline::bite_line {

namespace {

std::size_t lever_steps(double station_mm, double lever_mm) {
  return static_cast<std::size_t>(std::lround(lever_mm / station_mm));
}

/// RMS of `off_mm(trial, share)` over gaps of the same length that lie, with `beside` on both sides, where
/// all is known.
template <class Off>
TriedBridge tried(std::span<const std::uint8_t> known, const geometry::Gap& gap, std::size_t beside,
                  double station_mm, Off&& off_mm) {
  constexpr double k_stride_mm = 5.0;
  constexpr int k_fewest = 3;
  const std::size_t count = known.size();
  const std::size_t length = gap.steps + 2 * beside;
  const auto stride =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(k_stride_mm / station_mm)));
  TriedBridge sum;
  if (length >= count) return sum;
  int trials = 0;
  for (std::size_t from = 0; from < count; from += stride) {
    bool all_known = true;
    for (std::size_t k = 0; all_known && k <= length; ++k) all_known = known[(from + k) % count] != 0;
    if (!all_known) continue;
    const geometry::Gap trial{.first = (from + beside) % count, .steps = gap.steps};
    for (std::size_t eighth = 1; eighth <= TriedBridge::k_eighths; ++eighth) {
      const double share = static_cast<double>(eighth) / (2 * TriedBridge::k_eighths);
      const double off_first = off_mm(trial, share);
      const double off_last = off_mm(trial, 1 - share);
      sum.rms_mm.at(eighth - 1) += 0.5 * (off_first * off_first + off_last * off_last);
    }
    ++trials;
  }
  if (trials < k_fewest) return {};
  for (double& value : sum.rms_mm) value = std::sqrt(value / trials);
  return sum;
}

/// Both ends of the gap are known over the whole lever of their directions.
bool firm_ends(std::span<const std::uint8_t> known, const geometry::Gap& gap, double station_mm,
               double lever_mm) {
  const std::size_t count = known.size();
  const std::size_t reach = 2 * lever_steps(station_mm, lever_mm);
  if (gap.steps + 2 * reach >= count) return false;
  for (std::size_t k = 0; k <= reach; ++k) {
    if (known[(gap.first + count - k) % count] == 0) return false;
    if (known[(gap.first + gap.steps + k) % count] == 0) return false;
  }
  return true;
}

}  // namespace

bool is_long(const geometry::Gap& gap, double station_mm) {
  constexpr double k_long_mm = 8.0;
  return static_cast<double>(gap.steps) * station_mm >= k_long_mm;
}

std::vector<std::uint8_t> known_but_for_short(std::span<const std::uint8_t> known, double station_mm) {
  std::vector<std::uint8_t> nearly(known.begin(), known.end());
  for (const geometry::Gap& gap : geometry::gaps_of(known)) {
    if (is_long(gap, station_mm)) continue;
    for (std::size_t k = 1; k < gap.steps; ++k) nearly[(gap.first + k) % nearly.size()] = 1;
  }
  return nearly;
}

geometry::Arc gap_arc(std::span<const Vec2> plan, const geometry::Gap& gap, double station_mm,
                      double lever_mm) {
  const std::size_t count = plan.size();
  const std::size_t lever = lever_steps(station_mm, lever_mm);
  const std::size_t end = (gap.first + gap.steps) % count;
  const auto level = [&](std::size_t at) { return Vec3{plan[at].x(), plan[at].y(), 0}; };
  const auto back = [&](std::size_t k) { return level((gap.first + count - k % count) % count); };
  const auto ahead = [&](std::size_t k) { return level((end + k) % count); };
  return {
      .p0 = back(0),
      .d0 = geometry::CurveEnd{.end = back(0), .near = back(lever), .far = back(2 * lever)}.direction(),
      .p1 = ahead(0),
      .d1 = -geometry::CurveEnd{.end = ahead(0), .near = ahead(lever), .far = ahead(2 * lever)}.direction()};
}

std::optional<PlanBridge> firm_bridge(std::span<const Vec2> plan, std::span<const std::uint8_t> known,
                                      const geometry::Gap& gap, double station_mm) {
  if (!firm_ends(known, gap, station_mm, geometry::k_end_lever_mm)) return std::nullopt;
  constexpr double k_long_lever_mm = 2 * geometry::k_end_lever_mm;
  const bool firm_far = firm_ends(known, gap, station_mm, k_long_lever_mm);
  const geometry::Arc one = gap_arc(plan, gap, station_mm);
  return PlanBridge{.one = one, .other = firm_far ? gap_arc(plan, gap, station_mm, k_long_lever_mm) : one};
}

PlanBridge plan_bridge(std::span<const Vec2> plan, std::span<const std::uint8_t> known,
                       const geometry::Gap& gap, const Outline& outline, double station_mm) {
  if (const std::optional<PlanBridge> firm = firm_bridge(plan, known, gap, station_mm)) return *firm;
  const std::size_t end = (gap.first + gap.steps) % plan.size();
  const auto level = [](const Vec2& place) { return Vec3{place.x(), place.y(), 0}; };
  const auto along = [&](std::size_t at) {
    const Vec2 normal = outline.normal(static_cast<double>(at) * station_mm);
    return Vec3{-normal.y(), normal.x(), 0};
  };
  const Vec3 first = level(plan[gap.first]);
  const Vec3 last = level(plan[end]);
  return {.one = {.p0 = first, .d0 = last - first, .p1 = last, .d1 = last - first},
          .other = {.p0 = first, .d0 = along(gap.first), .p1 = last, .d1 = along(end)},
          .firm = false};
}

double TriedBridge::at(double share) const {
  const double eighths = 2 * k_eighths * std::clamp(std::min(share, 1 - share), 0.0, 0.5);
  const auto below = std::min(static_cast<std::size_t>(eighths), k_eighths - 1);
  const double low = below == 0 ? 0 : rms_mm.at(below - 1);
  return low + (eighths - static_cast<double>(below)) * (rms_mm.at(below) - low);
}

TriedBridge tried_plan(std::span<const Vec2> plan, std::span<const std::uint8_t> known,
                       const geometry::Gap& gap, double station_mm) {
  const auto off_mm = [&](const geometry::Gap& trial, double share) {
    const Vec2 place = gap_arc(plan, trial, station_mm).at(share).head<2>();
    double nearest2 = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k <= trial.steps; ++k)
      nearest2 = std::min(nearest2, (plan[(trial.first + k) % plan.size()] - place).squaredNorm());
    return std::sqrt(nearest2);
  };
  return tried(known, gap, 2 * lever_steps(station_mm, geometry::k_end_lever_mm), station_mm, off_mm);
}

TriedBridge tried_height(std::span<const double> z_mm, std::span<const std::uint8_t> known,
                         const geometry::Gap& gap, double station_mm) {
  const auto beside = static_cast<std::size_t>(std::lround(k_height_lever_mm / station_mm));
  const auto off_mm = [&](const geometry::Gap& trial, double share) {
    // The stretch alone: its lever, the gap, the other lever.
    const std::size_t count = z_mm.size();
    std::vector<double> stretch;
    for (std::size_t k = 0; k <= trial.steps + 2 * beside; ++k)
      stretch.push_back(z_mm[(trial.first + count - beside + k) % count]);
    const std::size_t place =
        beside + static_cast<std::size_t>(std::lround(share * static_cast<double>(trial.steps)));
    const double truth = stretch[place];
    std::vector<std::uint8_t> seen(stretch.size(), 1);
    std::fill_n(seen.begin() + static_cast<std::ptrdiff_t>(beside) + 1, trial.steps - 1, std::uint8_t{0});
    geometry::bridge_smooth(stretch, seen, station_mm, k_height_lever_mm);
    return stretch[place] - truth;
  };
  return tried(known, gap, beside, station_mm, off_mm);
}

std::vector<double> tried_heights(std::span<const double> z_mm, std::span<const std::uint8_t> known,
                                  std::span<const std::uint8_t> usual, double station_mm) {
  std::vector<double> tried(z_mm.size(), 0.0);
  for (const geometry::Gap& gap : geometry::gaps_of(known)) {
    if (!is_long(gap, station_mm)) continue;
    const TriedBridge off = tried_height(z_mm, usual, gap, station_mm);
    for (std::size_t k = 1; k < gap.steps; ++k)
      tried[(gap.first + k) % tried.size()] = off.at(static_cast<double>(k) / static_cast<double>(gap.steps));
  }
  return tried;
}

}  // namespace biteline::bite_line
