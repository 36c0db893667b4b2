// SPDX-License-Identifier: MIT
#pragma once
/// \file One least-squares problem over the whole head: camera, laser plane, mounting, and everything that
/// was in view.
///
/// Every ring of every picture, every stripe point and every robot pose is one observation with its own
/// noise.  Camera, plane and mounting come out together with one covariance, in which the errors that cancel
/// (a focal length too long puts the laser plane farther too) are seen to cancel.

#include <string>
#include <vector>

#include "common/geometry/sensor_model.hpp"
#include "host/calibration/camera/bundle.hpp"
#include "host/calibration/handeye/pose_adjustment.hpp"
#include "host/calibration/laser/laser_calibration.hpp"

namespace biteline::calibration {

/// A picture of one grid with nothing else known about its pose.
struct FreeView {
  PlaneView view;
  SE3 T_cam_target{SE3::Identity()};
};

/// A place of the laser target.
struct StripeView {
  std::vector<PlaneView> planes;  ///< one, or two
  std::vector<SE3> T_cam_plane;
  bool rigid{false};  ///< both planes related by HeadState::T_plane1_plane2
  std::vector<PlaneStripePoint> points;
};

/// A stop of the arm.
struct ArmView {
  PlaneView view;                      ///< numbered as all others
  SE3 T_base_flange{SE3::Identity()};  ///< as the robot says
};

struct HeadObservations {
  std::vector<FreeView> free;
  std::vector<StripeView> stripe;
  std::vector<ArmView> arm;
  double centre_sigma_px{0.05};
  PoseNoise pose_noise;
  bool camera_known{false};  ///< the camera stays as it is
};

struct HeadState {
  geometry::Camera camera;
  DistortionChoice distortion{true, true, true, true, true};
  geometry::LaserPlane plane;
  SE3 T_plane1_plane2{SE3::Identity()};
  SE3 T_flange_cam{SE3::Identity()};
  SE3 T_base_target{SE3::Identity()};
};

/// Order of the joint covariance: 9 of the camera, 3 of the plane (normal's turn about two axes across it,
/// distance at the points' middle), 6 of T_flange_cam (perturbation on the right).
inline constexpr int k_head_parameters = 18;
using HeadMatrix = Eigen::Matrix<double, k_head_parameters, k_head_parameters>;

struct HeadFit {
  HeadState state;
  HeadMatrix covariance{HeadMatrix::Zero()};  ///< rows of parts without observations are 0
  Eigen::Matrix<double, 3, 2> plane_axes{Eigen::Matrix<double, 3, 2>::Zero()};
  Vec3 plane_middle_cam{Vec3::Zero()};
  std::vector<std::vector<SE3>> T_cam_plane;  ///< per stripe view and grid, as adjusted
  double rms_px{0};                           ///< of all rings, distances
  double arm_rms_px{0};                       ///< of the arm's views alone
  double stripe_rms_mm{0};
  double stripe_sigma_factor{1};  ///< real noise of stripe points over the stated one
  double pose_rms_mm{0};          ///< robot positions as corrected, against as told
  double pose_rms_rad{0};
  bool converged{false};
  int iterations{0};

  [[nodiscard]] CameraVector camera_sigma() const { return covariance.diagonal().head<9>().cwiseSqrt(); }
  [[nodiscard]] Twist mounting_sigma() const { return covariance.diagonal().tail<6>().cwiseSqrt(); }
  /// Standard deviation (x, y, z in cam) of a point triangulated at a pixel, camera and plane both uncertain.
  [[nodiscard]] Vec3 triangulation_sigma_mm(const Vec2& pixel_px) const;
};

/// Levenberg-Marquardt (Ceres) from `start`; the stripe's noise level is estimated along.
[[nodiscard]] HeadFit solve_head(const HeadObservations& observations, const HeadState& start);

}  // namespace biteline::calibration
