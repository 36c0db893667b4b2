// SPDX-License-Identifier: MIT
#include "hal/sim/robot/real_joints.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace biteline::sim {

namespace {

constexpr std::int64_t k_remembered = 4096;  ///< steps: some four seconds
/// No joint goes so far in a step: the target was set elsewhere, and the arm is at rest there.
constexpr double k_jump_rad = 0.05;

/// The same joints, each by whole turns as near to `near_rad` as it can be.
JointVector turned_near(JointVector q_rad, const JointVector& near_rad) {
  for (Eigen::Index i = 0; i < 6; ++i)
    q_rad[i] = near_rad[i] + std::remainder(q_rad[i] - near_rad[i], 2 * std::numbers::pi);
  return q_rad;
}

SensorClock::time_point instant_of(std::int64_t number) {
  return SensorClock::time_point{number * JointDynamics::k_step};
}

}  // namespace

void RealJoints::advance(std::int64_t number, const TargetJoints& target) {
  Step& step = ring_[static_cast<std::size_t>(number % k_remembered)];
  const auto wanted = target(instant_of(number), q_last_rad_);
  if (!wanted) {
    dynamics_.reset();
    step = {};
    return;
  }
  const JointVector q_target_rad = dynamics_ ? turned_near(*wanted, q_last_rad_) : *wanted;
  if (!dynamics_ || (q_target_rad - q_last_rad_).cwiseAbs().maxCoeff() > k_jump_rad)
    dynamics_.emplace(settings_, q_target_rad);
  dynamics_->step(q_target_rad);
  q_last_rad_ = q_target_rad;
  step = {.known = true,
          .told_off_rad = dynamics_->q_told_rad() - q_target_rad,
          .link_off_rad = dynamics_->q_link_rad() - q_target_rad};
}

const RealJoints::Step& RealJoints::step_of(std::int64_t number) const {
  const std::int64_t kept = std::clamp(number, std::max<std::int64_t>(0, next_ - k_remembered), next_ - 1);
  return ring_[static_cast<std::size_t>(kept % k_remembered)];
}

std::optional<RealJoints::Joints> RealJoints::at(SensorClock::time_point instant,
                                                 const TargetJoints& target) {
  const std::int64_t before = instant.time_since_epoch() / JointDynamics::k_step;
  if (ring_.empty() || before - next_ > k_remembered) {  // never asked, or not for long: at rest till now
    ring_.assign(static_cast<std::size_t>(k_remembered), {});
    dynamics_.reset();
    next_ = std::max<std::int64_t>(0, before - 1);
  }
  for (; next_ <= before + 1; ++next_) advance(next_, target);
  const Step &a = step_of(before), &b = step_of(before + 1);
  const auto q_target_rad = target(instant, q_last_rad_);
  if (!a.known || !b.known || !q_target_rad) return std::nullopt;
  const double part = static_cast<double>((instant.time_since_epoch() % JointDynamics::k_step).count()) /
                      static_cast<double>(JointDynamics::k_step.count());
  return Joints{.q_told_rad = *q_target_rad + (1 - part) * a.told_off_rad + part * b.told_off_rad,
                .q_link_rad = *q_target_rad + (1 - part) * a.link_off_rad + part * b.link_off_rad};
}

}  // namespace biteline::sim
