// SPDX-License-Identifier: MIT
#pragma once
/// \file The simulated arm's state under RTDE's names and units.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/rtde/controller_session.hpp"
#include "hal/sim/robot/arm.hpp"
#include "hal/sim/robot/power.hpp"
#include "hal/sim/robot/program_watch.hpp"

namespace biteline::sim {

/// One controller cycle.  Call advance() once for each cycle, in order; speeds are differences to the cycle
/// before. What is named target is the program's, what is named actual the encoders'. Joints are followed
/// from cycle to cycle; where the links do not reach they keep their last values. What the simulation does
/// not have (currents, temperatures) reads 0.
class UrValues final : public rtde::ValueSource, public RtdeInputs {
 public:
  explicit UrValues(const ArmKinematics& kinematics) : kinematics_(kinematics) {}

  void advance(const ArmState& state, const ArmReal& real, double timestamp_s);

  /// What clients wrote: the speed slider, and all that is read back under its own name.  The outputs that
  /// they set with it.
  [[nodiscard]] std::vector<OutputStep> take_inputs(const rtde::Recipe& recipe,
                                                    std::span<const rtde::Value> values);
  [[nodiscard]] int input_register(int number) const override;
  [[nodiscard]] std::optional<SensorClock::time_point> written(const std::string& variable) const override;
  /// Held by the safety system, as after a collision.
  void set_protective_stop(bool on) { protective_stop_ = on; }
  void set_mode(RobotMode mode) { mode_ = mode; }
  /// On the tool at its tip, N in base axes, as the sensor tells it.
  void set_tcp_force(const Vec3& newton) { tcp_force_newton_ = newton; }
  /// output_int_register_N, as a program wrote it.
  void set_output_register(int number, int value) { output_registers_[number] = value; }
  [[nodiscard]] double speed_slider_ratio() const { return speed_slider_ratio_; }
  /// Standard inputs 0 to 7, as bits.
  void set_digital_inputs(std::uint64_t bits) { digital_inputs_ = bits; }
  /// Standard analog inputs, V.
  void set_analog_inputs(const std::array<double, 2>& volts) { analog_volts_ = volts; }
  /// By hand, at the pendant.
  void set_speed_slider(double ratio) { speed_slider_ratio_ = ratio; }
  /// What the controller's own limits leave of the programmed speed; beside the slider.
  [[nodiscard]] double speed_scaling() const { return speed_scaling_; }
  void set_speed_scaling(double ratio) { speed_scaling_ = ratio; }

  [[nodiscard]] rtde::Value value_of(std::string_view name) const override;

  [[nodiscard]] const ArmState& state() const { return state_; }
  /// As told in target_q; nothing while nobody knows.
  [[nodiscard]] const std::optional<JointVector>& q_rad() const { return q_rad_; }

 private:
  ArmKinematics kinematics_;
  ArmState state_;
  double timestamp_s_{0};
  double speed_slider_ratio_{1}, speed_scaling_{1};
  bool protective_stop_{false};
  RobotMode mode_{RobotMode::Running};
  std::uint64_t digital_inputs_{0};
  std::array<double, 2> analog_volts_{};
  Vec3 tcp_force_newton_{Vec3::Zero()};
  std::map<int, std::int32_t> output_registers_;
  std::map<std::string, rtde::Value, std::less<>> inputs_;
  std::map<std::string, SensorClock::time_point> written_;
  std::optional<JointVector> q_rad_;
  JointVector q_rad_s_{JointVector::Zero()};
  std::optional<JointVector> q_told_rad_;
  JointVector q_told_rad_s_{JointVector::Zero()};
  bool told_{false};  ///< by the arm itself
  SE3 T_base_flange_told_{SE3::Identity()};
  rtde::Vector6 tcp_target_{}, tcp_target_speed_{}, tcp_pose_{}, tcp_speed_{}, tcp_offset_{};
};

}  // namespace biteline::sim
