// SPDX-License-Identifier: MIT
#pragma once
/// \file What the simulated controller sends over its primary and secondary interfaces: Universal Robots,
/// "Client interfaces".  All numbers big-endian, lengths in metres.

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/time/clocks.hpp"
#include "hal/sim/robot/arm_kinematics.hpp"
#include "hal/sim/robot/power.hpp"

namespace biteline::sim::primary {

using Bytes = std::vector<std::uint8_t>;

/// Robot message "version", the first one that a client gets.
[[nodiscard]] Bytes version(const std::array<int, 3>& version, Nanoseconds stamp);
/// Robot message "key": a program's start or end.
[[nodiscard]] Bytes program_runs(bool runs, std::string_view program, Nanoseconds stamp);
/// Robot message "runtime exception": a program that cannot be read, or fails.
[[nodiscard]] Bytes runtime_exception(int line, int column, std::string_view text, Nanoseconds stamp);
/// Robot message "text": what a program says by textmsg.
[[nodiscard]] Bytes text(std::string_view text, Nanoseconds stamp);

enum class Level : std::int32_t { Warning = 2, Violation = 3 };
/// Robot message "error code": C`code`A`argument`.
[[nodiscard]] Bytes error(std::int32_t code, Level level, std::string_view text, Nanoseconds stamp);

enum class SafetyMode : std::uint8_t { Normal = 1, ProtectiveStop = 3 };
/// Robot message "safety mode", on each change.
[[nodiscard]] Bytes safety_mode(SafetyMode mode, Nanoseconds stamp);

struct Mode {
  RobotMode mode;
  bool protective_stop, program_running, program_paused;
  double speed_slider_ratio, speed_scaling;
};
/// Robot state with "robot mode data" alone.
[[nodiscard]] Bytes state(const Mode& mode, Nanoseconds stamp);
/// Robot state with "kinematics info" alone: check sums 0, rows, 0 for "calibrated".
[[nodiscard]] Bytes kinematics(const ArmKinematics& arm);
/// Robot state with "configuration data" alone: limits, nominal rows, and which arm it is; `model` as "UR5e".
[[nodiscard]] Bytes configuration(const ArmKinematics& arm, std::string_view model, bool cb3);

}  // namespace biteline::sim::primary
