// SPDX-License-Identifier: MIT
#include "common/geometry/sensor_model.hpp"

namespace biteline::geometry {

Vec3 triangulate(const Camera& camera, const LaserPlane& plane, const Vec2& pixel_px) {
  const Vec3 ray = camera.ray(pixel_px);
  return ray * (plane.distance_mm / plane.normal_cam.dot(ray));
}

}  // namespace biteline::geometry
