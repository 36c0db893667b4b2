// SPDX-License-Identifier: MIT
#include "common/geometry/camera.hpp"

namespace biteline::geometry {

Vec2 Camera::distort(const Vec2& ideal) const {
  const double x = ideal.x(), y = ideal.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Vec2 Camera::undistort(const Vec2& distorted) const {
  Vec2 ideal = distorted;
  for (int i = 0; i < 5; ++i) ideal += distorted - distort(ideal);
  for (int i = 0; i < 3; ++i) {
    constexpr double k_step = 1e-6;  // central difference: error about 1e-12 relative
    Eigen::Matrix2d J_distorted_ideal;
    J_distorted_ideal.col(0) =
        (distort(ideal + Vec2{k_step, 0}) - distort(ideal - Vec2{k_step, 0})) / (2 * k_step);
    J_distorted_ideal.col(1) =
        (distort(ideal + Vec2{0, k_step}) - distort(ideal - Vec2{0, k_step})) / (2 * k_step);
    ideal += J_distorted_ideal.inverse() * (distorted - distort(ideal));
  }
  return ideal;
}

Vec2 Camera::project(const Vec3& point_cam) const {
  const Vec2 distorted = distort({point_cam.x() / point_cam.z(), point_cam.y() / point_cam.z()});
  return {fu_px * distorted.x() + cu_px, fv_px * distorted.y() + cv_px};
}

Vec3 Camera::ray(const Vec2& pixel_px) const {
  const Vec2 ideal = undistort({(pixel_px.x() - cu_px) / fu_px, (pixel_px.y() - cv_px) / fv_px});
  return {ideal.x(), ideal.y(), 1.0};
}

}  // namespace biteline::geometry
