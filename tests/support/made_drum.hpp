// SPDX-License-Identifier: MIT
#pragma once
/// \file An upright drum, scanned in order from outside: its surface is a formula.

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "common/geometry/se3.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::test {

struct DrumScan {
  double radius_mm{50};
  double height_mm{30};
  int profiles{300};
  int columns{200};
  double noise_mm{0};
  bool clockwise{false};  ///< the way the scan goes round
  /// Change of the radius at a place (turn in rad, height in mm); a missing point where it says so.
  std::function<double(double, double)> bulge_mm{[](double, double) { return 0.0; }};
  std::function<bool(double, double)> missing{[](double, double) { return false; }};

  [[nodiscard]] cloud::PointCloud scan() const {
    std::mt19937_64 random{23};
    std::normal_distribution<double> noise{0, 1};
    cloud::PointCloud cloud;
    for (int profile = 0; profile < profiles; ++profile) {
      const double turn_rad = (clockwise ? -2 : 2) * std::numbers::pi * profile / profiles;
      for (int column = 0; column < columns; ++column) {
        const double z_mm = height_mm * column / (columns - 1);
        if (missing(turn_rad, z_mm)) continue;
        const double r_mm = radius_mm + bulge_mm(turn_rad, z_mm) + noise_mm * noise(random);
        cloud.points.push_back(
            Vec3{r_mm * std::cos(turn_rad), r_mm * std::sin(turn_rad), z_mm}.cast<float>());
        cloud.profile.push_back(static_cast<std::uint32_t>(profile));
        cloud.column.push_back(static_cast<std::uint16_t>(100 + column));
      }
    }
    return cloud;
  }
};

}  // namespace biteline::test
