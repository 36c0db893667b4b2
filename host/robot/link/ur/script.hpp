// SPDX-License-Identifier: MIT
#pragma once
/// \file A checked path as a URScript program.

#include <string>

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::robot::ur {

/// Tool frame and payload set, movej to the first waypoint's joints (that fixes the configuration), movel
/// down, movep along the line with blends that leave their neighbours room, movel away.  The tool's output is
/// on only along the line: off before the arm moves, and off before it leaves.  Of a path with its tool off
/// it is never on, and switched off at the same places.  A program that is halted does not get there:
/// UrLink::stop() sends one that does, and see docs/real-controller.md.  Universal Robots, "The URScript
/// Programming Language": p[] in m and rad, a in m/s^2, v in m/s, r in m.
[[nodiscard]] std::string urscript(const path::CheckedPath& path);

/// The program's name, as the controller reports it.
constexpr const char* k_program_name = "biteline_path";

}  // namespace biteline::robot::ur
