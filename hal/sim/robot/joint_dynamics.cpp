// SPDX-License-Identifier: MIT
#include "hal/sim/robot/joint_dynamics.hpp"

#include <numbers>

namespace biteline::sim {

namespace {

constexpr double k_step_s = static_cast<double>(JointDynamics::k_step.count()) * 1e-9;
/// The shoulder carries most and is the softest; the last wrist carries the head alone.
constexpr std::array k_stiffer{1.1, 1.0, 1.3, 1.8, 2.2, 2.5};

}  // namespace

double JointDynamics::joint_hz(double elastic_hz, Eigen::Index joint) {
  return elastic_hz * k_stiffer.at(static_cast<std::size_t>(joint));
}

JointDynamics::JointDynamics(const ArmDynamics& settings, const JointVector& q_rest_rad)
    : settings_(settings),
      on_the_way_(static_cast<std::size_t>(settings.latency / k_step), q_rest_rad),
      q_drive_rad_(q_rest_rad) {}

void JointDynamics::step(const JointVector& q_target_rad) {
  on_the_way_.push_back(q_target_rad);
  const JointVector q_asked_rad = on_the_way_.front();
  on_the_way_.pop_front();

  const JointVector speed_before = drive_rad_s_;
  if (settings_.following_s > 0) {
    // Critically damped: behind a steady target by 2 / w seconds, less the step that this one is ahead.
    const double w = 2 / (settings_.following_s + k_step_s);
    drive_rad_s_ += k_step_s * (w * w * (q_asked_rad - q_drive_rad_) - 2 * w * drive_rad_s_);
    q_drive_rad_ += k_step_s * drive_rad_s_;
  } else {
    drive_rad_s_ = (q_asked_rad - q_drive_rad_) / k_step_s;
    q_drive_rad_ = q_asked_rad;
  }
  if (settings_.elastic_hz <= 0) return;
  const JointVector acceleration = (drive_rad_s_ - speed_before) / k_step_s;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double w = 2 * std::numbers::pi * joint_hz(settings_.elastic_hz, i);
    give_rad_s_[i] += k_step_s * (-acceleration[i] - 2 * settings_.damping_ratio * w * give_rad_s_[i] -
                                  w * w * give_rad_[i]);
    give_rad_[i] += k_step_s * give_rad_s_[i];
  }
}

}  // namespace biteline::sim
