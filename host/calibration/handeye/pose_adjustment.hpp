// SPDX-License-Identifier: MIT
#pragma once
/// \file Weighted least squares over whole poses: T_flange_cam, the target's place, and how noisy the robot
/// is.

#include <span>
#include <vector>

#include "host/calibration/camera/plane_pose.hpp"
#include "host/calibration/handeye/motions.hpp"

namespace biteline::calibration {

/// A stop with the covariance of its seen pose (perturbation on T_cam_target's right; mm, rad).
struct WeightedStop {
  Stop stop;
  Mat6 covariance_seen{Mat6::Identity()};
};

struct PoseNoise {
  double sigma_mm{0.05};
  double sigma_rad{2e-4};
};

struct PoseAdjustment {
  SE3 T_flange_cam{SE3::Identity()};
  SE3 T_base_target{SE3::Identity()};
  Mat6 covariance{Mat6::Zero()};  ///< of T_flange_cam
  PoseNoise noise;
  bool converged{false};
};

/// Gauss-Newton on e_k = log(T_cam_target_k^-1 (T_base_flange_k T_flange_cam)^-1 T_base_target), weighted by
/// the seen pose's covariance plus the robot's noise carried there.
[[nodiscard]] PoseAdjustment adjust_poses(std::span<const WeightedStop> stops, const PoseAdjustment& start);

/// As adjust_poses(), and the noise itself by restricted maximum likelihood (Patterson and Thompson 1971),
/// position and rotation apart: what the residuals of one position and rotation mean is not known beforehand.
[[nodiscard]] PoseAdjustment adjust_poses_and_noise(std::span<const WeightedStop> stops,
                                                    const PoseAdjustment& start);

/// Residual of one stop under an adjustment: the target as predicted, in the target as seen.
[[nodiscard]] SE3 T_seen_predicted(const Stop& stop, const PoseAdjustment& adjustment);

/// Adjoint: Ad(T) xi is the perturbation on T's other side.
[[nodiscard]] Mat6 adjoint(const SE3& T);

}  // namespace biteline::calibration
