// SPDX-License-Identifier: MIT
#include "host/study/wear.hpp"

#include <algorithm>
#include <cmath>

#include "host/study/gage_study.hpp"

namespace biteline::study {

double student_95(int freedom) {
  constexpr double k_chance = 0.05;
  constexpr int k_halvings = 100;
  double low = 0, high = 20;  // one degree of freedom: 12.7
  for (int i = 0; i < k_halvings; ++i) {
    const double middle = 0.5 * (low + high);
    const bool beyond = chance_of_larger(middle * middle, {.above = 1, .below = freedom}) < k_chance;
    (beyond ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

Result<Trend> trend_of(std::span<const TrendPoint> points) {
  if (points.size() < 3) return fail(Errc::BadValue, "%zu points: a trend has at least 3", points.size());
  const auto n = static_cast<double>(points.size());
  Trend trend{.count = static_cast<int>(points.size())};
  double mean_value = 0;
  for (const TrendPoint& point : points) {
    trend.mean_x += point.x / n;
    mean_value += point.value / n;
  }
  double products = 0;
  for (const TrendPoint& point : points) {
    trend.squares_x += (point.x - trend.mean_x) * (point.x - trend.mean_x);
    products += (point.x - trend.mean_x) * (point.value - mean_value);
  }
  if (!(trend.squares_x > 0)) return fail(Errc::BadValue, "all %zu points at one place", points.size());
  trend.slope = products / trend.squares_x;
  trend.intercept = mean_value - trend.slope * trend.mean_x;
  double squares = 0;
  for (const TrendPoint& point : points) {
    const double off = point.value - mean_value - trend.slope * (point.x - trend.mean_x);
    squares += off * off;
  }
  trend.residual = std::sqrt(squares / (n - 2));
  trend.slope_error = trend.residual / std::sqrt(trend.squares_x);
  trend.intercept_error = trend.residual * std::sqrt(1 / n + trend.mean_x * trend.mean_x / trend.squares_x);
  trend.slope_u95 = student_95(trend.count - 2) * trend.slope_error;
  return trend;
}

std::optional<Crossing> crossing_of(const Trend& trend, const Limits& limits) {
  if (!trend.sure()) return std::nullopt;
  const double limit = trend.slope > 0 ? limits.high : limits.low;
  const double away = limit - trend.at(trend.mean_x);
  Crossing crossing{.limit = limit, .likely = trend.mean_x + away / trend.slope};
  // (away - slope u)^2 = w^2 (1 / n + u^2 / squares_x), u from the middle, w = t s.
  const double w2 = std::pow(trend.slope_u95, 2) * trend.squares_x;
  const double a = trend.slope * trend.slope - w2 / trend.squares_x, b = trend.slope * away,
               c = away * away - w2 / trend.count;
  // `a` is above 0 where the trend is sure, and so is this.
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  crossing.earliest = trend.mean_x + (b - root) / a;
  crossing.latest = trend.mean_x + (b + root) / a;
  return crossing;
}

}  // namespace biteline::study
