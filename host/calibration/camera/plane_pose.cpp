// SPDX-License-Identifier: MIT
#include "host/calibration/camera/plane_pose.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "host/calibration/rings/homography.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

/// d(pixel) / d(ideal), by central differences of the distortion (error about 1e-9 relative).
Eigen::Matrix2d J_pixel_ideal(const geometry::Camera& camera, const Vec2& ideal) {
  constexpr double k_step = 1e-5;
  Eigen::Matrix2d J;
  for (int i = 0; i < 2; ++i) {
    const Vec2 step = k_step * Vec2::Unit(i);
    J.col(i) = (camera.distort(ideal + step) - camera.distort(ideal - step)) / (2 * k_step);
  }
  J.row(0) *= camera.fu_px;
  J.row(1) *= camera.fv_px;
  return J;
}

/// Least absolute deviations (iteratively reweighted): a third of the rings elsewhere hardly moves it.
std::optional<PlanePose> fit_least_deviations(const geometry::Camera& camera,
                                              std::span<const CentreObservation> centres) {
  constexpr int k_rounds = 10;
  constexpr double k_least_px = 1e-3;
  std::vector<double> weights(centres.size(), 1.0);
  std::optional<PlanePose> pose;
  for (int round = 0; round < k_rounds; ++round) {
    pose = fit_plane_pose(camera, centres, weights);
    if (!pose) break;
    for (std::size_t i = 0; i < centres.size(); ++i) {
      const Vec2 expected_px = camera.project(pose->T_cam_target * centres[i].point_target);
      weights[i] = 1 / std::max(k_least_px, (expected_px - centres[i].pixel_px).norm());
    }
  }
  return pose;
}

}  // namespace

SE3 pose_from_homography(const Mat3& H_ideal_target) {
  // Zhang 2000, section 3.1: H = s [r1 r2 t]; the target stands before the camera.
  const double scale = 2 / (H_ideal_target.col(0).norm() + H_ideal_target.col(1).norm());
  const Mat3 H = H_ideal_target * (H_ideal_target(2, 2) > 0 ? scale : -scale);
  Mat3 R;
  R << H.col(0), H.col(1), H.col(0).cross(H.col(1));
  const Eigen::JacobiSVD<Mat3> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  SE3 T_cam_target = SE3::Identity();
  T_cam_target.linear() = svd.matrixU() *
                          Vec3(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant()).asDiagonal() *
                          svd.matrixV().transpose();
  T_cam_target.translation() = H.col(2);
  return T_cam_target;
}

std::optional<PlanePose> fit_plane_pose(const geometry::Camera& camera,
                                        std::span<const CentreObservation> centres,
                                        std::span<const double> weights) {
  std::vector<PlanePoint> ideal;
  for (const CentreObservation& centre : centres) {
    ideal.push_back({.plane = centre.point_target.head<2>(), .image = camera.ray(centre.pixel_px).head<2>()});
  }
  const std::optional<Mat3> H = fit_homography(ideal);
  if (!H) return std::nullopt;
  PlanePose pose{.T_cam_target = pose_from_homography(*H), .covariance_per_px2 = {}, .rms_px = 0};
  for (int iteration = 0; iteration < 20; ++iteration) {
    Mat6 information = Mat6::Zero();
    Twist gradient = Twist::Zero();
    double sum_px2 = 0;
    for (std::size_t i = 0; i < centres.size(); ++i) {
      const CentreObservation& centre = centres[i];
      const double weight = weights.empty() ? 1 : weights[i];
      const Vec3 p = pose.T_cam_target * centre.point_target;
      if (!(p.z() > 0)) return std::nullopt;
      const Vec2 place(p.x() / p.z(), p.y() / p.z());
      const Vec2 residual_px = centre.pixel_px - camera.project(p);
      Eigen::Matrix<double, 2, 3> J_ideal_point;
      J_ideal_point << 1 / p.z(), 0, -place.x() / p.z(), 0, 1 / p.z(), -place.y() / p.z();
      Eigen::Matrix<double, 3, 6> J_point_xi;  // T exp(xi) p = R (p + rho + theta x p) + t
      J_point_xi << pose.T_cam_target.linear(),
          -pose.T_cam_target.linear() * geometry::hat(centre.point_target);
      const Eigen::Matrix<double, 2, 6> J = J_pixel_ideal(camera, place) * J_ideal_point * J_point_xi;
      information += weight * J.transpose() * J;
      gradient += weight * J.transpose() * residual_px;
      sum_px2 += residual_px.squaredNorm();
    }
    const geometry::SymmetricSolver solver{information};
    const Twist step = solver.solve(gradient);
    if (!solver.sound() || !step.allFinite()) return std::nullopt;
    pose.covariance_per_px2 = solver.inverse();
    pose.rms_px = std::sqrt(sum_px2 / static_cast<double>(centres.size()));
    if (step.norm() < 1e-12 * pose.T_cam_target.translation().norm()) break;
    pose.T_cam_target = pose.T_cam_target * geometry::exp_se3(step);
  }
  return pose;
}

std::optional<PlanePose> fit_view_pose(const geometry::Camera& camera, PlaneView& view) {
  constexpr int k_rounds = 3;
  std::optional<PlanePose> pose = fit_plane_pose(camera, view.centres);
  for (int round = 0; pose && round < k_rounds; ++round) {
    improve_centres(view, camera, pose->T_cam_target);
    pose = fit_least_deviations(camera, view.centres);
    if (pose && set_rings_aside(view, camera, pose->T_cam_target) == 0 && round > 0) break;
  }
  return fit_plane_pose(camera, view.centres);
}

}  // namespace biteline::calibration
