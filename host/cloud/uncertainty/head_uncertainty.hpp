// SPDX-License-Identifier: MIT
#pragma once
/// \file How well a head is known: what its calibration states beside its values.

#include <array>
#include <optional>
#include <string_view>

#include "common/geometry/sensor_model.hpp"
#include "host/cloud/uncertainty/arm_give.hpp"

namespace biteline::uncertainty {

/// Order of the covariance: fu, fv, cu, cv [px], k1, k2, p1, p2, k3; the laser plane's normal turned about
/// two axes [rad] and its distance at a middle point [mm]; T_flange_cam's perturbation on the right, [mm]
/// then [rad]; the pose clock's offset [s].
inline constexpr int k_camera_parameters = 9;
inline constexpr int k_plane_parameters = 3;
inline constexpr int k_plane_at = k_camera_parameters;
inline constexpr int k_mounting_at = k_plane_at + k_plane_parameters;
inline constexpr int k_clock_at = k_mounting_at + 6;
inline constexpr int k_parameters = k_clock_at + 1;

using Parameters = Eigen::Matrix<double, k_parameters, 1>;
using Covariance = Eigen::Matrix<double, k_parameters, k_parameters>;

struct HeadUncertainty {
  Covariance covariance{Covariance::Zero()};
  /// Unit columns across the plane's normal: to these it turns.
  Eigen::Matrix<double, 3, 2> plane_axes{Eigen::Matrix<double, 3, 2>::Zero()};
  Vec3 plane_middle_cam{Vec3::Zero()};
  /// Standard deviations of one coordinate of a pose.  Neighbouring poses are off alike: nothing averages
  /// out.
  double pose_sigma_mm{0};
  double pose_sigma_rad{0};
  /// Of the arm, unseen by its encoders, per acceleration: one coordinate's standard deviation.
  std::optional<double> arm_give_mm_per_m_s2{};
};

/// Of an arm that a scan does not show: what is stated of it, else by earlier scans, else the assumption.
[[nodiscard]] ArmGive give_of(const std::optional<HeadUncertainty>& stated,
                              const std::optional<ArmGive>& earlier);

/// The head with its parameters off by `delta`.
[[nodiscard]] geometry::SensorModel perturbed(const geometry::SensorModel& head,
                                              const HeadUncertainty& uncertainty, const Parameters& delta);

/// d(point in flange, mm) / d(parameters) of the point that a full-sensor pixel sees; the clock's column is
/// 0, since it is the arm that moves the point there.  Central differences.
[[nodiscard]] Eigen::Matrix<double, 3, k_parameters> point_jacobian(const geometry::SensorModel& head,
                                                                    const HeadUncertainty& uncertainty,
                                                                    const Vec2& pixel_px);

}  // namespace biteline::uncertainty
