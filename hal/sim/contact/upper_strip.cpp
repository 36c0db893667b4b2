// SPDX-License-Identifier: MIT
#include "hal/sim/contact/upper_strip.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace biteline::sim {
namespace {

/// Heights of `rows` places along the section's surface above the line.
std::vector<double> heights_of(const Section& section, double line_z_mm, const UpperStrip& strip) {
  constexpr double k_step_mm = 0.1;
  std::vector<double> heights;
  double z_mm = line_z_mm, way_mm = 0, before_mm = section.offset_mm(z_mm);
  while (heights.size() < strip.rows) {
    const double wanted_mm = strip.low_mm + strip.piece_mm * static_cast<double>(heights.size());
    while (way_mm < wanted_mm && z_mm + k_step_mm < section.top_z_mm()) {
      z_mm += k_step_mm;
      const double now_mm = section.offset_mm(z_mm);
      way_mm += std::hypot(now_mm - before_mm, k_step_mm);
      before_mm = now_mm;
    }
    heights.push_back(z_mm);
  }
  return heights;
}

}  // namespace

UpperStrip upper_strip(const MadeShoe& shoe, std::span<const TrueLinePoint> line, const SE3& T_base_shoe,
                       const StripPlan& plan) {
  UpperStrip strip{.piece_mm = plan.piece_mm, .low_mm = plan.low_mm, .pieces = {}};
  if (line.size() < 2) return strip;
  strip.rows = 1 + static_cast<std::size_t>(std::floor((plan.high_mm - plan.low_mm) / plan.piece_mm));
  const double spacing_mm = shoe.perimeter_mm() / static_cast<double>(line.size());
  const auto each =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::round(plan.piece_mm / spacing_mm)));
  std::mt19937_64 random{plan.seed};
  std::uniform_real_distribution<double> phase_rad{0, 2 * std::numbers::pi};
  const double phases[2] = {phase_rad(random), phase_rad(random)};
  const auto [low, high] =
      std::ranges::minmax(line, {}, [](const TrueLinePoint& p) { return p.point_shoe.x(); });
  const double from_mm = low.point_shoe.x(), length_mm = high.point_shoe.x() - from_mm;
  for (std::size_t i = 0; i < line.size(); i += each) {
    const TrueLinePoint& here = line[i];
    const double turn = 2 * std::numbers::pi * here.s_mm / shoe.perimeter_mm();
    const double along = (here.point_shoe.x() - from_mm) / length_mm;
    const double stiffened = along < 1.0 / 6 || along > 5.0 / 6 ? plan.stiffened_ratio : 1;
    const double waves = std::sin(5 * turn + phases[0]) + std::sin(11 * turn + phases[1]);
    const double newton_per_mm3 = plan.newton_per_mm3 * stiffened * (1 + plan.uneven_ratio * waves / 2);
    const double area_mm2 = spacing_mm * static_cast<double>(each) * plan.piece_mm;
    const Section section = shoe.section(here.s_mm);
    for (const double z_mm : heights_of(section, here.point_shoe.z(), strip)) {
      strip.pieces.push_back({.point_base = T_base_shoe * section.point(z_mm),
                              .normal_base = T_base_shoe.linear() * shoe.normal(here.s_mm, z_mm),
                              .area_mm2 = area_mm2,
                              .newton_per_mm = newton_per_mm3 * area_mm2});
    }
  }
  return strip;
}

}  // namespace biteline::sim
