// SPDX-License-Identifier: MIT
#include "host/geometry/bridge.hpp"

#include <algorithm>
#include <cmath>

#include "host/geometry/closed_curve.hpp"
#include "host/geometry/fit.hpp"

namespace biteline::geometry {

namespace {

/// Cubic with values and derivatives per unit of its parameter at both ends (Hermite).
template <class Value>
Value hermite(const Value& p0, const Value& d0, const Value& p1, const Value& d1, double u) {
  const double u2 = u * u;
  const double u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * p0 + (u3 - 2 * u2 + u) * d0 + (3 * u2 - 2 * u3) * p1 + (u3 - u2) * d1;
}

/// Slope per station, by least squares over what is known of the stations from `at` on in steps of `away` (+1
/// or -1).
double slope_at(std::span<const double> values, std::span<const std::uint8_t> known, std::size_t at, int away,
                std::size_t lever) {
  LineSums sums;
  for (std::size_t k = 0; k <= lever; ++k) {
    const auto x = static_cast<std::ptrdiff_t>(k) * away;
    const std::size_t i = round_index(at, x, values.size());
    if (known[i] == 0) continue;
    sums.add(static_cast<double>(x), values[i]);
  }
  return sums.count() < 4 ? 0.0 : sums.slope().value_or(0.0);
}

}  // namespace

std::vector<Gap> gaps_of(std::span<const std::uint8_t> known) {
  std::vector<Gap> gaps;
  const std::size_t count = known.size();
  const auto first = static_cast<std::size_t>(std::find(known.begin(), known.end(), 1) - known.begin());
  if (first == count) return gaps;
  std::size_t last = first;
  for (std::size_t k = 1; k <= count; ++k) {
    const std::size_t i = first + k < count ? first + k : first + k - count;
    if (known[i] == 0) continue;
    const std::size_t steps = i > last ? i - last : i + count - last;
    if (steps > 1) gaps.push_back({.first = last, .steps = steps});
    last = i;
  }
  return gaps;
}

void drop_islands(std::vector<std::uint8_t>& known, double station_mm, double longest_mm) {
  const std::vector<Gap> gaps = gaps_of(known);
  const std::size_t count = known.size();
  for (std::size_t k = 0; k < gaps.size() && gaps.size() > 1; ++k) {
    const Gap& before = gaps[k];
    const Gap& behind = gaps[(k + 1) % gaps.size()];
    const std::size_t begin = (before.first + before.steps) % count;
    const std::size_t length = (behind.first + count - begin) % count + 1;
    if (static_cast<double>(length) * station_mm >= longest_mm ||
        length >= std::min(before.steps, behind.steps))
      continue;
    for (std::size_t i = 0; i < length; ++i) known[(begin + i) % count] = 0;
  }
}

void bridge_straight(std::vector<double>& values, std::span<const std::uint8_t> known, double station_mm) {
  bridge_smooth(values, known, station_mm, 0.0);
}

void bridge_means(std::vector<double>& values, std::span<const std::uint8_t> known, double station_mm,
                  double ends_mm) {
  const std::size_t count = values.size();
  const auto reach = static_cast<std::size_t>(ends_mm / station_mm);
  const std::vector<double> before = values;
  const auto mean_from = [&](std::size_t at, bool ahead) {
    double sum = 0;
    double n = 0;
    for (std::size_t k = 0; k <= reach; ++k) {
      const std::size_t i = ahead ? (at + k) % count : (at + count - k % count) % count;
      if (known[i] == 0) break;
      sum += before[i];
      n += 1;
    }
    return sum / n;  // the gap's own end is known
  };
  for (const Gap& gap : gaps_of(known)) {
    const double first = mean_from(gap.first, false);
    const double last = mean_from((gap.first + gap.steps) % count, true);
    for (std::size_t k = 1; k < gap.steps; ++k)
      values[(gap.first + k) % count] =
          first + (last - first) * static_cast<double>(k) / static_cast<double>(gap.steps);
  }
}

void bridge_smooth(std::vector<double>& values, std::span<const std::uint8_t> known, double station_mm,
                   double lever_mm) {
  const std::size_t count = values.size();
  const auto lever = static_cast<std::size_t>(lever_mm / station_mm);
  const std::vector<double> before = values;
  for (const Gap& gap : gaps_of(known)) {
    const std::size_t end = (gap.first + gap.steps) % count;
    const auto span = static_cast<double>(gap.steps);
    const double chord = before[end] - before[gap.first];
    const double d0 = lever == 0 ? chord : span * slope_at(before, known, gap.first, -1, lever);
    const double d1 = lever == 0 ? chord : span * slope_at(before, known, end, +1, lever);
    for (std::size_t k = 1; k < gap.steps; ++k)
      values[(gap.first + k) % count] =
          hermite(before[gap.first], d0, before[end], d1, static_cast<double>(k) / span);
  }
}

double Arc::turn_rad() const {
  return std::acos(std::clamp(d0.normalized().dot(d1.normalized()), -0.942, 1.0));
}

namespace {

constexpr double k_most_corner_rad = 2.8;

}  // namespace

double corner_beyond_chord_mm(double chord_mm, double turn_rad) {
  return 0.5 * chord_mm * std::tan(0.5 * std::clamp(turn_rad, 0.0, k_most_corner_rad));
}

double corner_beyond_arc_mm(double chord_mm, double turn_rad) {
  const double of_arc_rad = 0.5 * std::min(turn_rad, k_most_corner_rad);
  return corner_beyond_chord_mm(chord_mm, turn_rad) - corner_beyond_chord_mm(chord_mm, of_arc_rad);
}

Vec3 Arc::at(double share) const {
  const double theta = turn_rad();
  const double stretch = theta < 0.01 ? 1.0 : 2.0 * std::tan(0.25 * theta) / std::sin(0.5 * theta);
  const double length = stretch * (p1 - p0).norm();
  return hermite<Vec3>(p0, length * d0.normalized(), p1, length * d1.normalized(), share);
}

}  // namespace biteline::geometry
