// SPDX-License-Identifier: MIT
#pragma once
/// \file A shoe-like closed line: an oval 270 mm long and 100 mm wide whose height rises towards the toe.

#include <cmath>
#include <numbers>

#include "host/cloud/closed_line.hpp"

namespace biteline::path::test {

struct Oval {
  double half_length_mm{135};
  double half_width_mm{55};
  Vec3 middle{540, -60, 85};
  double rise_mm{6};
  double taper{0};  ///< above 0: wider towards +x, as a shoe is at its ball
};

/// About 1 mm apart, evenly; normals level and outward.
inline cloud::ClosedLine made_line(const Oval& oval = {}) {
  constexpr std::size_t k_fine = 20000;
  const auto at = [&](double angle_rad) {
    return Vec3(oval.middle +
                Vec3{oval.half_length_mm * std::cos(angle_rad),
                     oval.half_width_mm * std::sin(angle_rad) * (1 + oval.taper * std::cos(angle_rad)),
                     oval.rise_mm * std::cos(angle_rad)});
  };
  std::vector<double> arc_mm{0.0};
  for (std::size_t i = 1; i <= k_fine; ++i) {
    const double a = 2 * std::numbers::pi / k_fine;
    arc_mm.push_back(arc_mm.back() +
                     (at(a * static_cast<double>(i)) - at(a * static_cast<double>(i - 1))).norm());
  }
  const auto count = static_cast<std::size_t>(arc_mm.back());
  cloud::ClosedLine line;
  std::size_t i = 0;
  for (std::size_t k = 0; k < count; ++k) {
    while (arc_mm[i + 1] < arc_mm.back() * static_cast<double>(k) / static_cast<double>(count)) ++i;
    const double angle_rad = 2 * std::numbers::pi / k_fine * static_cast<double>(i);
    const Vec3 tangent =
        Vec3{-oval.half_length_mm * std::sin(angle_rad),
             oval.half_width_mm * (std::cos(angle_rad) + oval.taper * std::cos(2 * angle_rad)),
             -oval.rise_mm * std::sin(angle_rad)}
            .normalized();
    line.points.push_back({.position = at(angle_rad),
                           .normal = tangent.cross(Vec3::UnitZ()).normalized(),
                           .tangent = tangent,
                           .confidence = 1});
  }
  return line;
}

}  // namespace biteline::path::test
