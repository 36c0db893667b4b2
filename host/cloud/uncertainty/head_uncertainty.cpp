// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/head_uncertainty.hpp"

#include <cmath>

namespace biteline::uncertainty {

ArmGive give_of(const std::optional<HeadUncertainty>& stated, const std::optional<ArmGive>& earlier) {
  if (stated && stated->arm_give_mm_per_m_s2)
    return {.mm_per_m_s2 = *stated->arm_give_mm_per_m_s2, .source = ArmSource::Stated};
  return earlier.value_or(k_assumed_give);
}

geometry::SensorModel perturbed(const geometry::SensorModel& head, const HeadUncertainty& uncertainty,
                                const Parameters& delta) {
  geometry::SensorModel out = head;
  geometry::Camera& camera = out.camera;
  double* const values[k_camera_parameters] = {&camera.fu_px, &camera.fv_px, &camera.cu_px,
                                               &camera.cv_px, &camera.k1,    &camera.k2,
                                               &camera.p1,    &camera.p2,    &camera.k3};
  for (int i = 0; i < k_camera_parameters; ++i) *values[i] += delta[i];
  const geometry::LaserPlane& plane = head.laser_plane;
  const Vec3 normal = (plane.normal_cam + uncertainty.plane_axes * delta.segment<2>(k_plane_at)).normalized();
  const Vec3& seen = uncertainty.plane_middle_cam;
  const Vec3 middle = seen - plane.signed_distance_mm(seen) * plane.normal_cam;
  out.laser_plane = {.normal_cam = normal, .distance_mm = normal.dot(middle) + delta[k_plane_at + 2]};
  out.T_flange_cam = head.T_flange_cam * geometry::exp_se3(Twist{delta.segment<6>(k_mounting_at)});
  out.pose_clock_offset += Nanoseconds{std::llround(1e9 * delta[k_clock_at])};
  return out;
}

Eigen::Matrix<double, 3, k_parameters> point_jacobian(const geometry::SensorModel& head,
                                                      const HeadUncertainty& uncertainty,
                                                      const Vec2& pixel_px) {
  Eigen::Matrix<double, 3, k_parameters> J = Eigen::Matrix<double, 3, k_parameters>::Zero();
  for (int i = 0; i < k_clock_at; ++i) {
    const double step = i < 4 ? 1e-2 : 1e-5;  // px; coefficients, rad and mm
    const auto point = [&](double by) -> Vec3 {
      const geometry::SensorModel off = perturbed(head, uncertainty, by * Parameters::Unit(i));
      return off.T_flange_cam * geometry::triangulate(off.camera, off.laser_plane, pixel_px);
    };
    J.col(i) = (point(step) - point(-step)) / (2 * step);
  }
  return J;
}

}  // namespace biteline::uncertainty
