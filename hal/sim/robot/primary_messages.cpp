// SPDX-License-Identifier: MIT
#include "hal/sim/robot/primary_messages.hpp"

#include <algorithm>

#include "common/rtde/big_endian.hpp"

namespace biteline::sim::primary {
namespace {

constexpr std::uint32_t k_head_bytes = 5;
constexpr std::uint8_t k_robot_state = 16, k_robot_message = 20;

/// Length and type before `body`.
Bytes framed(std::uint8_t type, const Bytes& body) {
  Bytes bytes;
  rtde::Writer writer{bytes};
  writer.put(k_head_bytes + static_cast<std::uint32_t>(body.size()));
  writer.put(type);
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

/// A robot message whose body `fill` writes.
template <typename Fill>
Bytes message(std::uint8_t type, Nanoseconds stamp, const Fill& fill) {
  constexpr std::int8_t k_controller = -2;
  Bytes body;
  rtde::Writer writer{body};
  writer.put(static_cast<std::uint64_t>(stamp.count() / 1000));
  writer.put(k_controller);
  writer.put(type);
  fill(writer);
  return framed(k_robot_message, body);
}

}  // namespace

Bytes version(const std::array<int, 3>& version, Nanoseconds stamp) {
  constexpr std::uint8_t k_version = 3;
  return message(k_version, stamp, [&](rtde::Writer& writer) {
    constexpr std::string_view k_project = "URControl";
    writer.put(static_cast<std::uint8_t>(k_project.size()));
    writer.put_text(k_project);
    writer.put(static_cast<std::uint8_t>(version[0]));
    writer.put(static_cast<std::uint8_t>(version[1]));
    writer.put(std::int32_t{version[2]});
    writer.put(std::int32_t{0});  // build
    writer.put_text("simulated by Biteline");
  });
}

Bytes program_runs(bool runs, std::string_view program, Nanoseconds stamp) {
  constexpr std::uint8_t k_key = 7;
  return message(k_key, stamp, [&](rtde::Writer& writer) {
    const std::string_view title = runs ? "PROGRAM_XXX_STARTED" : "PROGRAM_XXX_STOPPED";
    writer.put(std::int32_t{0});  // code
    writer.put(std::int32_t{0});  // argument
    writer.put(static_cast<std::uint8_t>(title.size()));
    writer.put_text(title);
    writer.put_text(program);
  });
}

Bytes runtime_exception(int line, int column, std::string_view text, Nanoseconds stamp) {
  constexpr std::uint8_t k_runtime_exception = 10;
  return message(k_runtime_exception, stamp, [&](rtde::Writer& writer) {
    writer.put(static_cast<std::int32_t>(line));
    writer.put(static_cast<std::int32_t>(column));
    writer.put_text(text);
  });
}

Bytes text(std::string_view text, Nanoseconds stamp) {
  constexpr std::uint8_t k_text = 0;
  return message(k_text, stamp, [&](rtde::Writer& writer) { writer.put_text(text); });
}

Bytes error(std::int32_t code, Level level, std::string_view text, Nanoseconds stamp) {
  constexpr std::uint8_t k_error_code = 6;
  return message(k_error_code, stamp, [&](rtde::Writer& writer) {
    writer.put(code);
    writer.put(std::int32_t{0});  // argument
    writer.put(static_cast<std::int32_t>(level));
    writer.put(std::uint32_t{0});  // type of the data: none
    writer.put(std::uint32_t{0});  // data
    writer.put_text(text);
  });
}

Bytes safety_mode(SafetyMode mode, Nanoseconds stamp) {
  constexpr std::uint8_t k_safety_mode = 5;
  return message(k_safety_mode, stamp, [&](rtde::Writer& writer) {
    writer.put(std::int32_t{0});  // code
    writer.put(std::int32_t{0});  // argument
    writer.put(static_cast<std::uint8_t>(mode));
    writer.put(std::uint32_t{0});  // type of the data: none
    writer.put(std::uint32_t{0});  // data
  });
}

Bytes state(const Mode& mode, Nanoseconds stamp) {
  constexpr std::uint8_t k_robot_mode_data = 0;
  Bytes body;
  rtde::Writer writer{body};
  writer.put(static_cast<std::uint64_t>(stamp.count() / 1000));
  const bool on = mode.mode == RobotMode::Idle || mode.mode == RobotMode::Running;
  // Real robot connected, real robot enabled, power on, emergency stop, protective stop, program runs, pause.
  for (const bool flag : {true, true, on, false, mode.protective_stop,
                          mode.program_running && !mode.program_paused, mode.program_paused})
    writer.put(static_cast<std::uint8_t>(flag ? 1 : 0));
  writer.put(static_cast<std::uint8_t>(mode.mode));
  writer.put(std::uint8_t{0});  // control mode POSITION
  writer.put(mode.speed_slider_ratio);
  writer.put(mode.speed_scaling);
  writer.put(1.0);              // limit of the speed slider
  writer.put(std::uint8_t{0});  // kept free
  return framed(k_robot_state, framed(k_robot_mode_data, body));
}

Bytes kinematics(const ArmKinematics& arm) {
  constexpr std::uint8_t k_kinematics = 5;
  constexpr double k_m_per_mm = 1e-3;
  Bytes body;
  rtde::Writer writer{body};
  for (int joint = 0; joint < 6; ++joint) writer.put(std::uint32_t{0});
  using Row = ArmKinematics::DhRow;
  for (const Row& row : arm.rows()) writer.put(row.theta_rad);
  for (const Row& row : arm.rows()) writer.put(k_m_per_mm * row.a_mm);
  for (const Row& row : arm.rows()) writer.put(k_m_per_mm * row.d_mm);
  for (const Row& row : arm.rows()) writer.put(row.alpha_rad);
  writer.put(std::uint32_t{0});
  return framed(k_robot_state, framed(k_kinematics, body));
}

Bytes configuration(const ArmKinematics& arm, std::string_view model, bool cb3) {
  constexpr std::uint8_t k_configuration = 6;
  constexpr double k_m_per_mm = 1e-3;
  struct Type {
    std::string_view begin;
    std::int32_t number;
  };
  // Universal Robots, "Client interfaces", configuration data: robotType.  The longer first.
  constexpr std::array k_types{Type{"UR10", 2}, Type{"UR16", 4}, Type{"UR20", 7}, Type{"UR30", 8},
                               Type{"UR12", 2}, Type{"UR5", 1},  Type{"UR7", 1},  Type{"UR3", 3}};
  const auto* const type =
      std::ranges::find_if(k_types, [&](const Type& one) { return model.starts_with(one.begin); });
  // The defaults of URScript's moves, and the radius that turning counts with: rad/s, rad/s^2, m/s, m/s^2, m.
  constexpr std::array k_defaults{1.05, 1.4, 0.25, 1.2, 0.1};
  Bytes body;
  rtde::Writer writer{body};
  const JointLimits& limits = arm.limits();
  for (const double most_rad : limits.most_rad) {
    writer.put(-most_rad);
    writer.put(most_rad);
  }
  for (Eigen::Index joint = 0; joint < 6; ++joint) {
    writer.put(limits.speed_rad_s[joint]);
    writer.put(limits.acceleration_rad_s2[joint]);
  }
  for (const double value : k_defaults) writer.put(value);
  using Row = ArmKinematics::DhRow;
  for (const Row& row : arm.rows()) writer.put(k_m_per_mm * row.a_mm);
  for (const Row& row : arm.rows()) writer.put(k_m_per_mm * row.d_mm);
  for (const Row& row : arm.rows()) writer.put(row.alpha_rad);
  for (const Row& row : arm.rows()) writer.put(row.theta_rad);
  writer.put(std::int32_t{0});            // version of the master board
  writer.put(std::int32_t{cb3 ? 2 : 5});  // of the control box: CB3.1, e-Series
  writer.put(type == k_types.end() ? std::int32_t{0} : type->number);
  writer.put(std::int32_t{cb3 ? 1 : 2});  // sub type
  return framed(k_robot_state, framed(k_configuration, body));
}

}  // namespace biteline::sim::primary
