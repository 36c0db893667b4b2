// SPDX-License-Identifier: MIT
#include "hal/sim/robot/ur_values.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::sim {

namespace {

constexpr double k_m_per_mm = 1e-3;
/// UR's numbers, RTDE guide: safety mode NORMAL, runtime state STOPPED, PLAYING and PAUSED.
constexpr std::int32_t k_normal = 1;
constexpr std::uint32_t k_stopped = 1, k_playing = 2, k_paused = 4;
constexpr std::uint32_t k_power_on = 1U << 0U, k_program_running = 1U << 1U;
constexpr std::uint32_t k_safety_normal = 1U << 0U, k_safety_protective = 1U << 2U;
constexpr std::int32_t k_protective_stop = 3;
/// Analog outputs from 0 to 10 V; bits 2 and 3 of analog_io_types, same source.
constexpr double k_full_volts = 10;
constexpr std::uint32_t k_outputs_in_volts = 0b1100;
/// Joint mode RUNNING, same source.
constexpr std::int32_t k_joint_running = 253;

rtde::Vector6 ur_pose(const SE3& T) {
  const Vec3 p = k_m_per_mm * T.translation();
  const Vec3 r = geometry::log_so3(T.linear());
  return {p.x(), p.y(), p.z(), r.x(), r.y(), r.z()};
}

rtde::Vector6 to_array(const JointVector& q) {
  return {q[0], q[1], q[2], q[3], q[4], q[5]};
}

/// Linear speed of the tool's origin and turning speed, both in base.
rtde::Vector6 speed_between(const SE3& before, const SE3& after, double step_s) {
  const Vec3 v = k_m_per_mm / step_s * (after.translation() - before.translation());
  const Vec3 w = geometry::log_so3(after.linear() * before.linear().transpose()) / step_s;
  return {v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
}

/// The value of `name`, if the recipe has it.
template <class Kind>
const Kind* named(const rtde::Recipe& recipe, std::span<const rtde::Value> values, std::string_view name) {
  const auto at = std::ranges::find(recipe.names, name) - recipe.names.begin();
  return static_cast<std::size_t>(at) < values.size()
             ? std::get_if<Kind>(&values[static_cast<std::size_t>(at)])
             : nullptr;
}

/// Outputs whose bit of the mask is set.  Universal Robots, RTDE guide, "controller input": analog values
/// from 0 to 1.
std::vector<OutputStep> outputs_in(const rtde::Recipe& recipe, std::span<const rtde::Value> values) {
  constexpr std::array<std::pair<std::string_view, int>, 3> k_digital{
      {{"standard_digital_output", 0}, {"configurable_digital_output", 8}, {"tool_digital_output", 16}}};
  std::vector<OutputStep> set;
  for (const auto& [name, first] : k_digital) {
    const auto* mask = named<std::uint8_t>(recipe, values, std::string{name} + "_mask");
    const auto* bits = named<std::uint8_t>(recipe, values, name);
    const unsigned count = first == 16 ? 2 : 8;
    for (unsigned i = 0; mask != nullptr && bits != nullptr && i < count; ++i) {
      if (((*mask >> i) & 1U) != 0)
        set.emplace_back(DigitalOutStep{first + static_cast<int>(i), ((*bits >> i) & 1U) != 0});
    }
  }
  const auto* mask = named<std::uint8_t>(recipe, values, "standard_analog_output_mask");
  for (int i = 0; mask != nullptr && i < 2; ++i) {
    const auto* ratio = named<double>(recipe, values, "standard_analog_output_" + std::to_string(i));
    if (((*mask >> static_cast<unsigned>(i)) & 1U) != 0 && ratio != nullptr && *ratio >= 0 && *ratio <= 1)
      set.emplace_back(AnalogOutStep{i, *ratio});
  }
  return set;
}

}  // namespace

void UrValues::advance(const ArmState& state, const ArmReal& real, double timestamp_s) {
  const double step_s = timestamp_s - timestamp_s_;
  const bool first = timestamp_s_ == 0;
  const auto tip = [&](const SE3& T_before, const SE3& T_now, rtde::Vector6& pose, rtde::Vector6& speed) {
    const SE3 T_base_tcp = T_now * state.T_flange_tcp;
    speed = first || step_s <= 0 ? rtde::Vector6{}
                                 : speed_between(T_before * state.T_flange_tcp, T_base_tcp, step_s);
    pose = ur_pose(T_base_tcp);
  };
  tip(state_.T_base_flange, state.T_base_flange, tcp_target_, tcp_target_speed_);
  tip(T_base_flange_told_, real.T_base_flange_told, tcp_pose_, tcp_speed_);
  T_base_flange_told_ = real.T_base_flange_told;
  tcp_offset_ = ur_pose(state.T_flange_tcp);

  const bool still = !first && state_.T_base_flange.matrix() == state.T_base_flange.matrix();
  if (state.q_rad) {
    const bool moved = q_rad_ && state.moving && step_s > 0;
    q_rad_s_ = moved ? JointVector((*state.q_rad - *q_rad_) / step_s) : JointVector(JointVector::Zero());
    q_rad_ = state.q_rad;
  } else if (still) {
    q_rad_s_.setZero();
  } else {
    const auto followed = q_rad_ ? kinematics_.joints_near(state.T_base_flange, *q_rad_)
                                 : kinematics_.joints_anywhere(state.T_base_flange);
    const bool smooth = followed && q_rad_ && step_s > 0;
    q_rad_s_ = smooth ? JointVector((*followed - *q_rad_) / step_s) : JointVector(JointVector::Zero());
    if (followed) q_rad_ = followed;
  }
  const std::optional<JointVector> q_told_rad = real.q_told_rad ? real.q_told_rad : q_rad_;
  q_told_rad_s_ = q_rad_s_;
  // Joints found from a pose may be others by whole turns: from those to the encoders' is no way gone.
  const bool both_told = std::exchange(told_, real.q_told_rad.has_value()) && told_;
  if (both_told && q_told_rad_ && step_s > 0) q_told_rad_s_ = (*q_told_rad - *q_told_rad_) / step_s;
  q_told_rad_ = q_told_rad;
  state_ = state;
  timestamp_s_ = timestamp_s;
}

std::vector<OutputStep> UrValues::take_inputs(const rtde::Recipe& recipe,
                                              std::span<const rtde::Value> values) {
  std::uint32_t slider_mask = 0;
  double slider = speed_slider_ratio_;
  for (std::size_t i = 0; i < values.size() && i < recipe.names.size(); ++i) {
    const std::string& name = recipe.names[i];
    if (name == "speed_slider_mask") slider_mask = std::get<std::uint32_t>(values[i]);
    if (name == "speed_slider_fraction") slider = std::get<double>(values[i]);
    if (name.starts_with("input_")) inputs_[name] = values[i];
    written_[name] = hal::monotonic_now();
  }
  if ((slider_mask & 1U) != 0 && slider >= 0 && slider <= 1) speed_slider_ratio_ = slider;
  return outputs_in(recipe, values);
}

int UrValues::input_register(int number) const {
  const auto input = inputs_.find("input_int_register_" + std::to_string(number));
  const auto* value = input == inputs_.end() ? nullptr : std::get_if<std::int32_t>(&input->second);
  return value == nullptr ? 0 : *value;
}

std::optional<SensorClock::time_point> UrValues::written(const std::string& variable) const {
  const auto known = written_.find(variable);
  return known == written_.end() ? std::nullopt : std::optional{known->second};
}

rtde::Value UrValues::value_of(std::string_view name) const {
  if (name == "timestamp") return timestamp_s_;
  if (name == "target_q") return to_array(q_rad_.value_or(JointVector::Zero()));
  if (name == "target_qd") return to_array(q_rad_s_);
  if (name == "target_TCP_pose") return tcp_target_;
  if (name == "target_TCP_speed") return tcp_target_speed_;
  if (name == "actual_q") return to_array(q_told_rad_.value_or(JointVector::Zero()));
  if (name == "actual_qd") return to_array(q_told_rad_s_);
  if (name == "actual_TCP_pose") return tcp_pose_;
  if (name == "actual_TCP_speed") return tcp_speed_;
  if (name == "tcp_offset") return tcp_offset_;
  if (name == "robot_mode") return static_cast<std::int32_t>(mode_);
  if (name == "safety_mode" || name == "safety_status")
    return protective_stop_ ? k_protective_stop : k_normal;
  if (name == "joint_mode") {
    rtde::Vector6Int32 modes;
    modes.fill(k_joint_running);
    return modes;
  }
  if (name == "runtime_state")
    return state_.paused ? k_paused : state_.program_running ? k_playing : k_stopped;
  if (name == "robot_status_bits") {
    const bool on = mode_ == RobotMode::Idle || mode_ == RobotMode::Running;
    return (on ? k_power_on : 0U) | (state_.program_running && !state_.paused ? k_program_running : 0U);
  }
  if (name == "safety_status_bits") return protective_stop_ ? k_safety_protective : k_safety_normal;
  if (name == "speed_scaling") return speed_scaling_;
  if (name == "target_speed_fraction") return speed_slider_ratio_;
  if (const auto input = inputs_.find(name); input != inputs_.end()) return input->second;
  if (name == "actual_TCP_force")
    return rtde::Vector6{tcp_force_newton_.x(), tcp_force_newton_.y(), tcp_force_newton_.z(), 0, 0, 0};
  constexpr std::string_view k_register = "output_int_register_";
  if (name.starts_with(k_register)) {
    const int number = std::atoi(std::string{name.substr(k_register.size())}.c_str());
    const auto known = output_registers_.find(number);
    return known == output_registers_.end() ? std::int32_t{0} : known->second;
  }
  if (name == "payload") return state_.payload.mass_kg;
  if (name == "payload_cog") {
    const Vec3 centre_m = k_m_per_mm * state_.payload.centre_mm;
    return rtde::Vector3{centre_m.x(), centre_m.y(), centre_m.z()};
  }
  if (name == "actual_digital_input_bits") return digital_inputs_;
  if (name == "standard_analog_input0") return analog_volts_[0];
  if (name == "standard_analog_input1") return analog_volts_[1];
  if (name == "actual_digital_output_bits") return std::uint64_t{state_.outputs};
  if (name == "standard_analog_output0") return k_full_volts * state_.analog_ratio[0];
  if (name == "standard_analog_output1") return k_full_volts * state_.analog_ratio[1];
  if (name == "analog_io_types") return k_outputs_in_volts;
  const auto type = rtde::output_type(name);
  return rtde::zero_of(type.value_or(rtde::FieldType::Double));
}

}  // namespace biteline::sim
