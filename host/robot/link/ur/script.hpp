// SPDX-License-Identifier: MIT
#pragma once
/// \file A checked path as a URScript program.

#include <optional>
#include <string>

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::robot::ur {

/// The dead man: what ends a program that nobody watches any more, by the controller alone. The host counts
/// an RTDE input register up while it watches (UrLink::beat()). A thread of the program looks at it this
/// often; a count that stands still for so many looks switches the tool's output off and halts the program.
/// The looks take 0.05 s and a cycle at most, 8 ms on a CB3, so it acts 0.35 to 0.47 s after the last count.
inline constexpr double k_look_s = 0.05;
inline constexpr int k_most_still_looks = 7;
/// After it, should the thread itself not run: the controller's own watchdog ends the program 0.5 s after the
/// last count. It leaves the outputs as they are, so the thread must come first.
inline constexpr double k_watchdog_hz = 2;
/// From the last count to a halted program with its tool off.
inline constexpr double k_dead_man_s = 0.5;

/// Tool frame and payload set, movej to the first waypoint's joints (that fixes the configuration), movel
/// down, movep along the line with blends that leave their neighbours room, movel away.  The tool's output is
/// on only along the line: off before the arm moves, and off before it leaves.  Of a path with its tool off
/// it is never on, and switched off at the same places.  A program that is halted does not get there:
/// UrLink::stop() sends one that does, and see docs/real-controller.md.  Universal Robots, "The URScript
/// Programming Language": p[] in m and rad, a in m/s^2, v in m/s, r in m; threads, rtde_set_watchdog.
/// `beat_register`: of the dead man, input_int_register_N; none: a program that nobody need watch.
[[nodiscard]] std::string urscript(const path::CheckedPath& path,
                                   const std::optional<int>& beat_register = {});

/// The program's name, as the controller reports it.
constexpr const char* k_program_name = "biteline_path";

}  // namespace biteline::robot::ur
