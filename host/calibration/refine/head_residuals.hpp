// SPDX-License-Identifier: MIT
#pragma once
/// \file What the adjustment of the whole head minimises, one functor per kind of observation.  Only for
/// head_bundle.cpp.

#include <ceres/ceres.h>

#include "host/calibration/camera/reprojection.hpp"
#include "host/calibration/refine/head_bundle.hpp"

namespace biteline::calibration {

template <class T>
using V3 = Eigen::Matrix<T, 3, 1>;

inline double value_of(double x) {
  return x;
}
template <class T, int N>
double value_of(const ceres::Jet<T, N>& x) {
  return x.a;
}

/// Viewing ray of a pixel with derivatives by the camera's parameters: the exact inverse as a number, then
/// one Newton step in T, which leaves the value and adds the derivatives of the implicit function.
template <class T>
V3<T> ray_of(const T* camera, const Vec2& pixel_px) {
  CameraVector now;
  for (int i = 0; i < k_camera_parameters; ++i) now[i] = value_of(camera[i]);
  const Vec3 ray = to_camera(now).ray(pixel_px);
  constexpr double k_step = 1e-6;
  Eigen::Matrix2d J;
  for (int i = 0; i < 2; ++i) {
    const Vec3 step = k_step * Vec3::Unit(i);
    J.col(i) =
        (project<double>(now.data(), ray + step) - project<double>(now.data(), ray - step)) / (2 * k_step);
  }
  const Eigen::Matrix<T, 2, 1> miss = project<T>(camera, ray.cast<T>()) - pixel_px.cast<T>();
  const Eigen::Matrix<T, 2, 1> ideal = ray.head<2>().cast<T>() - J.inverse().cast<T>() * miss;
  return {ideal[0], ideal[1], T(1)};
}

/// A ring seen by a camera, the target's pose T_cam_target * xi.
struct FreeRing {
  CentreObservation seen;
  SE3 T_cam_target;
  double sigma_px;

  template <class T>
  bool operator()(const T* camera, const T* xi, T* residual) const {
    const V3<T> p = moved<T>(T_cam_target, xi, seen.point_target.cast<T>());
    if (!(p[2] > T(0))) return false;
    const Eigen::Matrix<T, 2, 1> pixel = project(camera, p);
    residual[0] = (pixel[0] - seen.pixel_px.x()) / sigma_px;
    residual[1] = (pixel[1] - seen.pixel_px.y()) / sigma_px;
    return true;
  }
};

/// A ring of the second plane of a rigid pair: T_cam_plane1 * xi, then T_plane1_plane2 * xi_12.
struct SecondPlaneRing {
  CentreObservation seen;
  SE3 T_cam_plane1, T_plane1_plane2;
  double sigma_px;

  template <class T>
  bool operator()(const T* camera, const T* xi, const T* xi_12, T* residual) const {
    const V3<T> p1 = moved<T>(T_plane1_plane2, xi_12, seen.point_target.cast<T>());
    const V3<T> p = moved<T>(T_cam_plane1, xi, p1);
    if (!(p[2] > T(0))) return false;
    const Eigen::Matrix<T, 2, 1> pixel = project(camera, p);
    residual[0] = (pixel[0] - seen.pixel_px.x()) / sigma_px;
    residual[1] = (pixel[1] - seen.pixel_px.y()) / sigma_px;
    return true;
  }
};

/// The laser plane as n . (X - middle) = shift with n = n0 + a e1 + b e2, |n| = 1.
struct PlaneModel {
  Vec3 normal, middle;
  Eigen::Matrix<double, 3, 2> axes;

  template <class T>
  T distance(const T* delta, const V3<T>& point) const {
    V3<T> n = normal.cast<T>() + axes.col(0).cast<T>() * delta[0] + axes.col(1).cast<T>() * delta[1];
    n /= n.norm();
    return n.dot(point - middle.cast<T>()) - delta[2];
  }
};

/// Distance from the laser plane of a stripe point, put onto the target's plane through its viewing ray; in
/// standard deviations of its row.
struct Stripe {
  StripePoint seen;
  SE3 T_cam_plane1, T_plane1_plane2;  ///< the second is the identity on the first plane
  PlaneModel plane;
  double mm_per_px;  ///< of the distance along the rows
  double factor;     ///< on the stated noise

  template <class T>
  bool operator()(const T* camera, const T* delta, const T* xi, const T* xi_12, T* residual) const {
    const V3<T> zero = V3<T>::Zero(), unit(T(0), T(0), T(1));
    const V3<T> origin = moved<T>(T_cam_plane1, xi, moved<T>(T_plane1_plane2, xi_12, zero));
    const V3<T> tip = moved<T>(T_cam_plane1, xi, moved<T>(T_plane1_plane2, xi_12, unit));
    const V3<T> normal = tip - origin, ray = ray_of(camera, seen.pixel_px);
    const V3<T> point = ray * (normal.dot(origin) / normal.dot(ray));
    residual[0] = plane.distance(delta, point) / (mm_per_px * seen.sigma_px * factor);
    return true;
  }
};

/// As FreeRing through the arm: the flange's true pose is T_base_flange * xi_flange.
struct ArmRing {
  CentreObservation seen;
  SE3 T_base_flange, T_flange_cam, T_base_target;
  double sigma_px;

  template <class T>
  bool operator()(const T* camera, const T* xi_flange, const T* xi_mount, const T* xi_target,
                  T* residual) const {
    const V3<T> p_base = moved<T>(T_base_target, xi_target, seen.point_target.cast<T>());
    const V3<T> p_flange = moved_back<T>(T_base_flange, xi_flange, p_base);
    const V3<T> p = moved_back<T>(T_flange_cam, xi_mount, p_flange);
    if (!(p[2] > T(0))) return false;
    const Eigen::Matrix<T, 2, 1> pixel = project(camera, p);
    residual[0] = (pixel[0] - seen.pixel_px.x()) / sigma_px;
    residual[1] = (pixel[1] - seen.pixel_px.y()) / sigma_px;
    return true;
  }

  /// Inverse of moved().
  template <class T>
  static V3<T> moved_back(const SE3& T_start, const T* xi, const V3<T>& point) {
    V3<T> p = T_start.linear().transpose().cast<T>() * (point - T_start.translation().cast<T>());
    p -= Eigen::Map<const V3<T>>(xi);
    const T back[3] = {-xi[3], -xi[4], -xi[5]};
    V3<T> turned;
    ceres::AngleAxisRotatePoint(back, p.data(), turned.data());
    return turned;
  }
};

struct RobotPrior {
  PoseNoise noise;
  template <class T>
  bool operator()(const T* xi, T* residual) const {
    for (int i = 0; i < 3; ++i) {
      residual[i] = xi[i] / noise.sigma_mm;
      residual[i + 3] = xi[i + 3] / noise.sigma_rad;
    }
    return true;
  }
};

}  // namespace biteline::calibration
