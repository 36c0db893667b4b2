// SPDX-License-Identifier: MIT
#include "hal/sim/robot/primary_messages.hpp"

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

Bytes runtime_exception(int line, std::string_view text, Nanoseconds stamp) {
  constexpr std::uint8_t k_runtime_exception = 10;
  return message(k_runtime_exception, stamp, [&](rtde::Writer& writer) {
    writer.put(static_cast<std::int32_t>(line));
    writer.put(std::int32_t{1});  // column
    writer.put_text(text);
  });
}

Bytes warning(std::string_view text, Nanoseconds stamp) {
  constexpr std::uint8_t k_error_code = 6;
  return message(k_error_code, stamp, [&](rtde::Writer& writer) {
    writer.put(std::int32_t{0});   // code
    writer.put(std::int32_t{0});   // argument
    writer.put(std::int32_t{2});   // level: warning
    writer.put(std::uint8_t{0});   // type of the data: none
    writer.put(std::uint32_t{0});  // data
    writer.put_text(text);
  });
}

Bytes state(const Mode& mode, Nanoseconds stamp) {
  constexpr std::uint8_t k_robot_mode_data = 0;
  Bytes body;
  rtde::Writer writer{body};
  writer.put(static_cast<std::uint64_t>(stamp.count() / 1000));
  // Real robot connected, real robot enabled, power on, emergency stop, protective stop, program runs, pause.
  for (const bool flag : {true, true, mode.powered, false, mode.protective_stop, mode.program_running, false})
    writer.put(static_cast<std::uint8_t>(flag ? 1 : 0));
  writer.put(static_cast<std::uint8_t>(mode.powered ? 7 : 3));  // robot mode RUNNING, POWER_OFF
  writer.put(std::uint8_t{0});                                  // control mode POSITION
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

}  // namespace biteline::sim::primary
