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

namespace biteline::sim::primary {

using Bytes = std::vector<std::uint8_t>;

/// Robot message "version", the first one that a client gets.
[[nodiscard]] Bytes version(const std::array<int, 3>& version, Nanoseconds stamp);
/// Robot message "key": a program's start or end.
[[nodiscard]] Bytes program_runs(bool runs, std::string_view program, Nanoseconds stamp);
/// Robot message "runtime exception": a program that cannot be read, or fails.
[[nodiscard]] Bytes runtime_exception(int line, std::string_view text, Nanoseconds stamp);
/// Robot message "error code" at the level of a warning.
[[nodiscard]] Bytes warning(std::string_view text, Nanoseconds stamp);

struct Mode {
  bool powered, protective_stop, program_running;
  double speed_slider_ratio, speed_scaling;
};
/// Robot state with "robot mode data" alone.
[[nodiscard]] Bytes state(const Mode& mode, Nanoseconds stamp);
/// Robot state with "kinematics info" alone: check sums 0, rows, 0 for "calibrated".
[[nodiscard]] Bytes kinematics(const ArmKinematics& arm);

}  // namespace biteline::sim::primary
