// SPDX-License-Identifier: MIT
#pragma once
/// \file How far two calibrations of one head are apart where it counts.

#include <algorithm>

#include "common/geometry/sensor_model.hpp"

namespace biteline::test {

/// How far apart the two heads put the points that one stripe may show, in the flange's frame.
/// `pixel_ratio`: how many pixels they have for one of the published head, each way.
inline double farthest_mm(const geometry::SensorModel& a, const geometry::SensorModel& b,
                          double pixel_ratio = 1) {
  const auto place = [](const geometry::SensorModel& head, const Vec2& pixel_px) {
    const Vec3 ray = head.camera.ray(pixel_px);
    const double depth_mm = head.laser_plane.distance_mm / head.laser_plane.normal_cam.dot(ray);
    return Vec3(head.T_flange_cam * Vec3(depth_mm * ray));
  };
  double farthest = 0;
  for (double u = 200; u <= 1400; u += 200) {
    for (double v = 450; v <= 800; v += 50)
      farthest = std::max(farthest,
                          (place(a, pixel_ratio * Vec2{u, v}) - place(b, pixel_ratio * Vec2{u, v})).norm());
  }
  return farthest;
}

}  // namespace biteline::test
