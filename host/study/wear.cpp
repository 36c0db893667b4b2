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

Result<Trend> trend_within(std::span<const std::vector<TrendPoint>> groups) {
  Trend trend;
  std::vector<TrendPoint> off;  // from each group's means
  int levels = 0;
  double mean_value = 0;
  for (const std::vector<TrendPoint>& group : groups) {
    if (group.empty()) continue;
    ++levels;
    TrendPoint mean;
    for (const TrendPoint& point : group) {
      mean.x += point.x / static_cast<double>(group.size());
      mean.value += point.value / static_cast<double>(group.size());
    }
    for (const TrendPoint& point : group)
      off.push_back({.x = point.x - mean.x, .value = point.value - mean.value});
    trend.mean_x += mean.x * static_cast<double>(group.size());
    mean_value += mean.value * static_cast<double>(group.size());
  }
  trend.count = static_cast<int>(off.size());
  const int freedom = trend.count - levels - 1;
  if (freedom < 1)
    return fail(Errc::BadValue, "%d points in %d series: a trend has 2 more than series", trend.count,
                levels);
  trend.mean_x /= trend.count;
  double products = 0;
  for (const TrendPoint& point : off) {
    trend.squares_x += point.x * point.x;
    products += point.x * point.value;
  }
  if (!(trend.squares_x > 0)) return fail(Errc::BadValue, "all %d points at one place", trend.count);
  trend.slope = products / trend.squares_x;
  trend.intercept = mean_value / trend.count - trend.slope * trend.mean_x;
  double squares = 0;
  for (const TrendPoint& point : off) squares += std::pow(point.value - trend.slope * point.x, 2);
  trend.residual = std::sqrt(squares / freedom);
  trend.slope_error = trend.residual / std::sqrt(trend.squares_x);
  trend.intercept_error =
      trend.residual * std::sqrt(1.0 / trend.count + trend.mean_x * trend.mean_x / trend.squares_x);
  trend.slope_u95 = student_95(freedom) * trend.slope_error;
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
