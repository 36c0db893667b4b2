// SPDX-License-Identifier: MIT
#pragma once
/// \file The linear steps of A X = X B.

#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"

namespace biteline::calibration {

/// A stop with its target's pose in a chosen reading.
struct Stop {
  SE3 T_base_flange{SE3::Identity()};
  SE3 T_cam_target{SE3::Identity()};
};

/// Unit axis times sin(angle / 2): the quaternion's vector part, sign such that the angle is at most pi.
[[nodiscard]] Vec3 half_axis(const Mat3& R);

/// Rotation of T_flange_cam from all pairs of stops (Park and Martin 1994 with half axes; Procrustes).
/// Nothing when the axes are parallel.
[[nodiscard]] std::optional<Mat3> rotation_of_x(std::span<const Stop> stops);

struct TranslationFit {
  Vec3 translation_mm{Vec3::Zero()};
  double pose_scale{1};  ///< factor on the robot's lengths that fits best: 1, or 1000 for metres
  double pose_scale_sigma{0};
  double rms_mm{0};  ///< of the equations, with the scale free
};

/// (R_A - 1) t_X - R_X t_B + s t_A = 0 over all pairs (Tsai and Lenz 1989, eq. 15, with the unit left open).
[[nodiscard]] std::optional<TranslationFit> translation_of_x(std::span<const Stop> stops,
                                                             const Mat3& R_flange_cam);

/// How much the arm turned and about how different axes.
struct TurningSpread {
  double largest_turn_rad{0};
  double axes_spread_rad{0};  ///< atan of the ratio of the axes' second to first standard deviation
};
[[nodiscard]] TurningSpread turning_spread(std::span<const SE3> T_base_flanges);

}  // namespace biteline::calibration
