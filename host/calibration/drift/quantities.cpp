// SPDX-License-Identifier: MIT
#include "host/calibration/drift/quantities.hpp"

namespace biteline::drift {

uncertainty::HeadUncertainty axes_of(const geometry::SensorModel& head) {
  uncertainty::HeadUncertainty axes;
  const Vec3& n = head.laser_plane.normal_cam;
  // The stripe stands along the image's columns' numbers: x of the camera, as far as it lies in the plane.
  const Vec3 stripe = (Vec3::UnitX() - n.x() * n).normalized();
  // A turn about an axis moves the normal along the other one.
  axes.plane_axes.col(0) = stripe.cross(n);
  axes.plane_axes.col(1) = stripe;
  axes.plane_middle_cam = head.laser_plane.distance_mm * n;
  return axes;
}

Eigen::Matrix<double, uncertainty::k_parameters, k_quantities> parameters_per_quantity() {
  using namespace uncertainty;
  Eigen::Matrix<double, k_parameters, k_quantities> map =
      Eigen::Matrix<double, k_parameters, k_quantities>::Zero();
  // fu and fv together: a lens moves along its axis.
  map(0, 0) = map(1, 0) = k_table[0].si;
  map(2, 1) = k_table[1].si;
  map(3, 2) = k_table[2].si;
  for (int i = 0; i < k_plane_parameters; ++i)
    map(k_plane_at + i, 3 + i) = k_table.at(static_cast<std::size_t>(3 + i)).si;
  for (int i = 0; i < 6; ++i) map(k_mounting_at + i, 6 + i) = k_table.at(static_cast<std::size_t>(6 + i)).si;
  map(k_clock_at, k_head_quantities - 1) = k_table[k_head_quantities - 1].si;
  return map;
}

uncertainty::Parameters parameters_of(const Vector& x) {
  return parameters_per_quantity() * x;
}

}  // namespace biteline::drift
