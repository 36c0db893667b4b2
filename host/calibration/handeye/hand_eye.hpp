// SPDX-License-Identifier: MIT
#pragma once
/// \file Where the camera sits on the robot's flange, from views of one fixed target.

#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/calibration/camera/camera_calibration.hpp"
#include "host/calibration/camera/plane_pose.hpp"

namespace biteline::calibration {

/// One stop of the arm: what the robot says and what the camera sees.
struct HandEyeView {
  std::string name;
  SE3 T_base_flange{SE3::Identity()};
  PlanePose pose;                 ///< T_cam_target in the view's first reading
  std::vector<Reading> readings;  ///< the grid's equally good numberings (GridView)
};

/// As Result of the linear stage and the least-squares stage, for each used view.
struct HandEyeStop {
  std::size_t view{0};                ///< index in the input
  std::size_t reading{0};             ///< index in its readings
  SE3 T_cam_target{SE3::Identity()};  ///< in the reading that all views share
  double left_out_mm{0};              ///< target's middle, predicted from the other views, against seen
  double left_out_rad{0};
};

struct HandEyeCalibration {
  SE3 T_flange_cam{SE3::Identity()};
  SE3 T_base_target{SE3::Identity()};
  Mat6 covariance{Mat6::Zero()};  ///< of T_flange_cam's perturbation [rho; theta] on the right; mm, rad
  double pose_sigma_mm{0};        ///< the robot's position noise per pose, as the residuals show it
  double pose_sigma_rad{0};
  double left_out_rms_mm{0};
  double left_out_rms_rad{0};
  double axes_spread_rad{
      0};  ///< angle between the rotation axes' two main directions, as their scatter shows it
  double largest_turn_rad{0};
  std::vector<HandEyeStop> stops;
  std::vector<SetAside> set_aside;
};

struct HandEyeOptions {
  double centre_sigma_px{0.05};      ///< noise of one coordinate of a ring's centre
  Vec3 middle_target{Vec3::Zero()};  ///< where left-out errors are told
  double most_sigma_mm{1.0};         ///< a mounting less certain than that is refused
  double most_sigma_rad{5e-3};
  double most_left_out_mm{5.0};  ///< a robot and a camera that agree no better are refused
};

/// A X = X B in two linear steps (rotation, then translation with a common scale to find wrong units), over
/// the largest set of views that agree on one rotation under some reading of the grid; then weighted least
/// squares with the robot's noise estimated along (restricted maximum likelihood).  Refuses with the reason:
/// fewer than 3 motions, parallel rotation axes, too little turning, poses inverted, in other units or with
/// their quaternion in another order, mirrored pictures, robot and camera disagreeing.
[[nodiscard]] Result<HandEyeCalibration> calibrate_hand_eye(const std::vector<HandEyeView>& views,
                                                            const HandEyeOptions& options);

}  // namespace biteline::calibration
