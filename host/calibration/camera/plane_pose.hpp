// SPDX-License-Identifier: MIT
#pragma once
/// \file Pose of a plane target from one picture, the camera known.

#include <optional>
#include <span>

#include "host/calibration/camera/plane_view.hpp"

namespace biteline::calibration {

using Mat6 = Eigen::Matrix<double, 6, 6>;

struct PlanePose {
  SE3 T_cam_target{SE3::Identity()};
  Mat6 covariance_per_px2{
      Mat6::Zero()};  ///< of the perturbation [rho; theta] on the right, for 1 px of centre noise
  double rms_px{0};   ///< sqrt of the mean squared distance, over points
};

/// Pose from a homography to ideal coordinates.
[[nodiscard]] SE3 pose_from_homography(const Mat3& H_ideal_target);

/// Closed form, then Gauss-Newton on the reprojections, each with its weight (empty: all alike).  Nothing
/// when the points are too few or lie on a line.
[[nodiscard]] std::optional<PlanePose> fit_plane_pose(const geometry::Camera& camera,
                                                      std::span<const CentreObservation> centres,
                                                      std::span<const double> weights = {});

/// The same with the view's centres improved under its pose, and damaged rings set aside.
[[nodiscard]] std::optional<PlanePose> fit_view_pose(const geometry::Camera& camera, PlaneView& view);

}  // namespace biteline::calibration
