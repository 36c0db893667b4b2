// SPDX-License-Identifier: MIT
#pragma once
/// \file The camera model and rigid perturbations for automatic differentiation.  Only for files that include
/// Ceres anyway.

#include <ceres/rotation.h>

#include <Eigen/Core>

#include "common/geometry/camera.hpp"

namespace biteline::calibration {

/// Order of the camera's parameters in one Ceres block.
enum CameraParameter : int { k_fu, k_fv, k_cu, k_cv, k_k1, k_k2, k_p1, k_p2, k_k3, k_camera_parameters };

/// As geometry::Camera::project (a test compares them), for any scalar.
template <class T>
Eigen::Matrix<T, 2, 1> project(const T* camera, const Eigen::Matrix<T, 3, 1>& point_cam) {
  const T x = point_cam[0] / point_cam[2], y = point_cam[1] / point_cam[2];
  const T r2 = x * x + y * y;
  const T radial = T(1) + r2 * (camera[k_k1] + r2 * (camera[k_k2] + r2 * camera[k_k3]));
  const T p1 = camera[k_p1], p2 = camera[k_p2];
  return {camera[k_fu] * (x * radial + T(2) * p1 * x * y + p2 * (r2 + T(2) * x * x)) + camera[k_cu],
          camera[k_fv] * (y * radial + p1 * (r2 + T(2) * y * y) + T(2) * p2 * x * y) + camera[k_cv]};
}

/// T_start * (xi applied to point): rotation by theta, then shift by rho; to first order T_start * exp(xi) *
/// point.
template <class T>
Eigen::Matrix<T, 3, 1> moved(const SE3& T_start, const T* xi, const Eigen::Matrix<T, 3, 1>& point) {
  Eigen::Matrix<T, 3, 1> turned;
  ceres::AngleAxisRotatePoint(xi + 3, point.data(), turned.data());
  turned += Eigen::Map<const Eigen::Matrix<T, 3, 1>>(xi);
  return T_start.linear().cast<T>() * turned + T_start.translation().cast<T>();
}

/// The motion that moved() with the identity applies.
[[nodiscard]] inline SE3 perturbation(const double* xi) {
  SE3 T = SE3::Identity();
  T.linear() = geometry::exp_so3(Eigen::Map<const Vec3>(xi + 3));
  T.translation() = Eigen::Map<const Vec3>(xi);
  return T;
}

[[nodiscard]] inline Eigen::Matrix<double, k_camera_parameters, 1> to_parameters(const geometry::Camera& c) {
  Eigen::Matrix<double, k_camera_parameters, 1> p;
  p << c.fu_px, c.fv_px, c.cu_px, c.cv_px, c.k1, c.k2, c.p1, c.p2, c.k3;
  return p;
}

[[nodiscard]] inline geometry::Camera to_camera(const Eigen::Matrix<double, k_camera_parameters, 1>& p) {
  return {.fu_px = p[k_fu],
          .fv_px = p[k_fv],
          .cu_px = p[k_cu],
          .cv_px = p[k_cv],
          .k1 = p[k_k1],
          .k2 = p[k_k2],
          .p1 = p[k_p1],
          .p2 = p[k_p2],
          .k3 = p[k_k3]};
}

}  // namespace biteline::calibration
