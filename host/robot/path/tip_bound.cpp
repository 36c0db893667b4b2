// SPDX-License-Identifier: MIT
#include "host/robot/path/tip_bound.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/robot/path/give.hpp"

namespace biteline::path {

double largest_give_mm(const PlannedPath& path, const kinematics::ArmModel& arm) {
  std::vector<GivePlace> places;
  for (const Waypoint& w : path.waypoints)
    places.push_back({.q_rad = w.q_rad,
                      .work_base = w.line_base,
                      .arc_mm = w.arc_mm,
                      .speed_mm_s = w.speed_mm_s,
                      .time_s = w.time_s});
  const std::vector<double> give_mm = give_along_mm(arm, places);
  double largest_mm = 0;
  for (std::size_t i = 0; i < give_mm.size(); ++i)
    if (path.waypoints[i].segment == Segment::Line) largest_mm = std::max(largest_mm, give_mm[i]);
  return largest_mm;
}

TipParts parts_of(const PlannedPath& path, const std::optional<double>& line_u95_mm) {
  return {.line_u95_mm = line_u95_mm, .give_mm = path.give_mm, .tip_u95_mm = path.tip_u95_mm};
}

std::optional<double> tip_sum_mm(const TipParts& parts) {
  if (!parts.line_u95_mm) return std::nullopt;
  return parts.give_mm + std::hypot(*parts.line_u95_mm, parts.tip_u95_mm);
}

std::optional<double> tip_bound_mm(const TipParts& parts) {
  const std::optional<double> sum_mm = tip_sum_mm(parts);
  if (!sum_mm) return std::nullopt;
  return k_bound_factor * *sum_mm;
}

std::optional<double> risk_beyond(const TipParts& parts, double tolerance_mm) {
  const std::optional<double> sum_mm = tip_sum_mm(parts);
  if (!sum_mm) return std::nullopt;
  if (!(*sum_mm > 0)) return 0;
  const double sigmas = (tolerance_mm / *sum_mm - k_mean_ratio) / k_ratio_sigma;
  return 0.5 * std::erfc(sigmas / std::numbers::sqrt2);
}

}  // namespace biteline::path
