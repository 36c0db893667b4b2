// SPDX-License-Identifier: MIT
#pragma once
/// \file Joint dynamics along a clock: how far told and true joints are from their target at any instant.

#include <functional>
#include <optional>
#include <vector>

#include "hal/sim/robot/joint_dynamics.hpp"

namespace biteline::sim {

/// The joints that the controller asks for at an instant, near the ones given; nothing where nobody knows.
using TargetJoints =
    std::function<std::optional<JointVector>(SensorClock::time_point, const JointVector& near_rad)>;

/// Goes on by whole milliseconds as it is asked, and remembers the last few seconds: pictures are asked for
/// after their time.  Not thread-safe.
class RealJoints {
 public:
  struct Joints {
    JointVector q_told_rad, q_link_rad;
  };

  explicit RealJoints(const ArmDynamics& settings) : settings_(settings) {}

  /// Nothing where the target's joints are not known: the arm is ideal there.
  [[nodiscard]] std::optional<Joints> at(SensorClock::time_point instant, const TargetJoints& target);

 private:
  struct Step {
    bool known{false};
    JointVector told_off_rad{JointVector::Zero()}, link_off_rad{JointVector::Zero()};
  };
  void advance(std::int64_t number, const TargetJoints& target);
  [[nodiscard]] const Step& step_of(std::int64_t number) const;

  ArmDynamics settings_;
  std::optional<JointDynamics> dynamics_{};
  JointVector q_last_rad_{JointVector::Zero()};
  std::vector<Step> ring_{};
  std::int64_t next_{0};  ///< number of the step that comes next, milliseconds of the clock
};

}  // namespace biteline::sim
