// SPDX-License-Identifier: MIT
#include "hal/sim/robot/force_control.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace biteline::sim {
namespace {

/// Of the sensor's error over places: a shoe is some 300 mm long, and its error changes over it.
constexpr double k_shortest_mm = 300, k_longest_mm = 900;
/// Back to the program's way when force mode has ended.
constexpr double k_back_mm_s = 50;
constexpr int k_fixed_frame = 2;  ///< force_mode's type: the task frame is taken as it is told

double clamp_or(double value, double low, double high) {
  return std::isfinite(value) ? std::clamp(value, low, high) : low;
}

}  // namespace

ForceControl::ForceControl(const ForceFacts& facts, Touch touch)
    : facts_{facts}, touch_{std::move(touch)}, random_{facts.noise_seed} {
  std::mt19937_64 of_arm{facts.seed};
  std::normal_distribution<double> one{0, 1};
  std::uniform_real_distribution<double> length_mm{k_shortest_mm, k_longest_mm},
      phase_rad{0, 2 * std::numbers::pi};
  for (auto& axis : waves_) {
    for (Wave& wave : axis) {
      const Vec3 direction = Vec3{one(of_arm), one(of_arm), one(of_arm)}.normalized();
      wave = {.per_mm = 2 * std::numbers::pi / length_mm(of_arm) * direction, .phase_rad = phase_rad(of_arm)};
    }
  }
  one.reset();
  drift_newton_per_s_ = facts.drift_newton_per_s * Vec3{one(random_), one(random_), one(random_)};
}

bool ForceControl::begin(std::span<const ScriptValue> arguments) {
  if (arguments.size() != 5) return false;
  const auto* frame = std::get_if<ScriptPose>(arguments.data());
  const auto* selection = std::get_if<ScriptPose>(&arguments[1]);
  const auto* wrench = std::get_if<ScriptPose>(&arguments[2]);
  const auto* type = std::get_if<double>(&arguments[3]);
  const auto* limits = std::get_if<ScriptPose>(&arguments[4]);
  if (frame == nullptr || selection == nullptr || wrench == nullptr || type == nullptr || limits == nullptr)
    return false;
  if (*type != k_fixed_frame || (*selection)[3] != 0 || (*selection)[4] != 0 || (*selection)[5] != 0)
    return false;
  R_base_task_ = to_se3(*frame).linear();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    compliant_[i] = (*selection)[i] != 0;
    wanted_newton_[axis] = (*wrench)[i];
    limit_mm_s_[axis] = k_script_mm_per_m * std::abs((*limits)[i]);
  }
  if (!std::exchange(on_, true)) speed_base_mm_s_.setZero();
  return true;
}

bool ForceControl::act(std::string_view function, std::span<const ScriptValue> arguments) {
  const auto* number = arguments.size() == 1 ? std::get_if<double>(arguments.data()) : nullptr;
  if (function == "force_mode") return begin(arguments);
  if (function == "end_force_mode") {
    on_ = false;
  } else if (function == "zero_ftsensor") {
    zero_tcp_ = raw_tcp_;
  } else if (function == "force_mode_set_damping" && number != nullptr) {
    damping_ = clamp_or(*number, 0, 1);
  } else if (function == "force_mode_set_gain_scaling" && number != nullptr) {
    gain_ = clamp_or(*number, 0, 2);
  } else {
    return false;
  }
  return true;
}

Vec3 ForceControl::error_at(const Vec3& tip_base) const {
  Vec3 error = Vec3::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const Wave& wave : waves_[axis])
      error[static_cast<Eigen::Index>(axis)] += std::sin(wave.per_mm.dot(tip_base) + wave.phase_rad);
  }
  // The mean square of each wave is a half.
  return facts_.place_newton * std::sqrt(2.0 / static_cast<double>(k_waves)) * error;
}

void ForceControl::sense(const SE3& T_base_tcp, double step_s) {
  std::normal_distribution<double> noise{0, 1};
  const Vec3 errors = error_at(T_base_tcp.translation()) + time_s_ * drift_newton_per_s_;
  const Vec3 noises = facts_.noise_newton * Vec3{noise(random_), noise(random_), noise(random_)};
  const Mat3 R = T_base_tcp.linear();
  // A sensor is zeroed over some readings: the noise of one is not in its zero.
  raw_tcp_ = R.transpose() * true_newton_ + errors;
  told_newton_ = R * (raw_tcp_ - zero_tcp_ + noises);
  const double share = facts_.lag_s > 0 ? 1 - std::exp(-step_s / facts_.lag_s) : 1;
  slow_newton_ += share * (told_newton_ - slow_newton_);
}

void ForceControl::regulate(double step_s) {
  Vec3 speed = R_base_task_.transpose() * speed_base_mm_s_;
  // What presses on the tool is the other way round than what it presses with.
  const Vec3 pressed = -(R_base_task_.transpose() * slow_newton_);
  Vec3 off = R_base_task_.transpose() * off_base_mm_;
  const double braking_per_s = facts_.braking_per_s + damping_ * facts_.damping_per_s;
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (!compliant_[static_cast<std::size_t>(i)]) {
      // These follow the program, also when the task frame turns.
      speed[i] = 0;
      off[i] -= std::clamp(off[i], -k_back_mm_s * step_s, k_back_mm_s * step_s);
      continue;
    }
    const double missing = wanted_newton_[i] - pressed[i];
    speed[i] += step_s * (gain_ * facts_.answer_mm_s2_newton * missing - braking_per_s * speed[i]);
    speed[i] = std::clamp(speed[i], -limit_mm_s_[i], limit_mm_s_[i]);
  }
  speed_base_mm_s_ = R_base_task_ * speed;
  off_base_mm_ = R_base_task_ * (off + step_s * speed);
}

void ForceControl::let_go(double step_s) {
  const double off_mm = off_base_mm_.norm(), back_mm = k_back_mm_s * step_s;
  off_base_mm_ = off_mm > back_mm ? Vec3{(1 - back_mm / off_mm) * off_base_mm_} : Vec3{Vec3::Zero()};
}

void ForceControl::step(const SE3& T_base_tcp, double step_s) {
  SE3 T = T_base_tcp;
  T.translation() += off_base_mm_;
  true_newton_ = touch_ ? touch_(T, step_s) : Vec3{Vec3::Zero()};
  sense(T, step_s);
  if (on_) {
    regulate(step_s);
  } else {
    let_go(step_s);
  }
  time_s_ += step_s;
}

}  // namespace biteline::sim
