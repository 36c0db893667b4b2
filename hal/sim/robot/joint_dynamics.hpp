// SPDX-License-Identifier: MIT
#pragma once
/// \file What lies between the joints that a controller asks for and those that the arm has.

#include <deque>

#include "common/time/clocks.hpp"
#include "hal/sim/robot/arm_kinematics.hpp"

namespace biteline::sim {

/// All zero: an ideal arm, which is where it is told to be.
struct ArmDynamics {
  /// The softest joint's own frequency; the others are stiffer, up to 2.5 times for the last one.  0: stiff.
  double elastic_hz{0};
  /// Of an arm's joints: a shaken arm is at rest again after a dozen swings.
  double damping_ratio{0.05};
  /// The encoders sit behind the gears and see their give; this share, of links and mounting, they do not.
  double unseen_ratio{0.3};
  /// By so much the drives are behind the controller's target at a steady speed.  Pre: 0, or 0.002 and more.
  double following_s{0};
  /// From the controller's target to the drives.
  Nanoseconds latency{0};

  [[nodiscard]] bool ideal() const { return elastic_hz <= 0 && following_s <= 0 && latency.count() <= 0; }
};

/// An arm as arms of this kind are.  8 to 20 Hz, and a tenth of a millimetre at the tip at 0.25 m/s round a
/// shoe's toe, follow from stiffness and load of such arms; 10 ms and two cycles from their controllers.
[[nodiscard]] constexpr ArmDynamics common_arm_dynamics() {
  return {.elastic_hz = 8, .following_s = 0.010, .latency = Nanoseconds{4'000'000}};
}

/// Drives follow their target as a critically damped second order, links hang on the drives by springs.
/// Steps of k_step; not thread-safe.
class JointDynamics {
 public:
  static constexpr Nanoseconds k_step{1'000'000};

  JointDynamics(const ArmDynamics& settings, const JointVector& q_rest_rad);

  void step(const JointVector& q_target_rad);
  /// What the controller reports.
  [[nodiscard]] JointVector q_told_rad() const {
    return q_drive_rad_ + (1 - settings_.unseen_ratio) * give_rad_;
  }
  /// Where the links are.
  [[nodiscard]] JointVector q_link_rad() const { return q_drive_rad_ + give_rad_; }

  /// Own frequency of a joint, 0 to 5, of an arm whose softest has `elastic_hz`.
  [[nodiscard]] static double joint_hz(double elastic_hz, Eigen::Index joint);

 private:
  ArmDynamics settings_;
  std::deque<JointVector> on_the_way_;  ///< targets that the drives have not got yet
  JointVector q_drive_rad_, drive_rad_s_{JointVector::Zero()};
  JointVector give_rad_{JointVector::Zero()}, give_rad_s_{JointVector::Zero()};
};

}  // namespace biteline::sim
