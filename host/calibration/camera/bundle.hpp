// SPDX-License-Identifier: MIT
#pragma once
/// \file Least squares over camera and target poses together.

#include <array>
#include <span>
#include <vector>

#include "host/calibration/camera/plane_view.hpp"

namespace biteline::calibration {

inline constexpr int k_camera_count = 9;  ///< fu fv cu cv k1 k2 p1 p2 k3
using CameraVector = Eigen::Matrix<double, k_camera_count, 1>;
using CameraMatrix = Eigen::Matrix<double, k_camera_count, k_camera_count>;

/// Which of k1 k2 p1 p2 k3 are estimated; the others are 0.
using DistortionChoice = std::array<bool, 5>;

struct BundleFit {
  geometry::Camera camera;
  std::vector<SE3> T_cam_target;  ///< per view
  CameraMatrix covariance_per_px2{
      CameraMatrix::Zero()};  ///< for 1 px of noise per coordinate; 0 where not estimated
  double sum_px2{0};          ///< of the squared residuals
  int residuals{0};
  int unknowns{0};
  int iterations{0};
  bool converged{false};

  /// Noise of one coordinate of a centre, with the degrees of freedom taken off.
  [[nodiscard]] double sigma_px() const;
  /// sqrt of the mean squared distance, over points.
  [[nodiscard]] double rms_px() const;
};

struct BundleStart {
  geometry::Camera camera;
  std::vector<SE3> T_cam_target;
  DistortionChoice distortion{true, true, true, true, true};
  bool with_covariance{false};
};

/// Levenberg-Marquardt (Ceres) over the reprojections of every centre of `views`.
[[nodiscard]] BundleFit solve_bundle(std::span<const PlaneView* const> views, const BundleStart& start);

}  // namespace biteline::calibration
