// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a process's zones lie on a line, and what is worked in one go.

#include <optional>
#include <span>
#include <vector>

#include "host/cloud/closed_line.hpp"
#include "host/robot/path/checks/line_check.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::path {

/// The shoe's two ends as its line alone tells them: the widest part, and so the middle of the area, lies
/// nearer to the toe.
struct ShoeEnds {
  Vec2 heel_to_toe{1, 0};  ///< unit, level
  double heel_mm{0};       ///< least and largest place of the line along it, from the frame's origin
  double toe_mm{0};
  double lead_ratio{0};  ///< of the length: how much nearer the middle of the area lies to the toe
};
[[nodiscard]] ShoeEnds shoe_ends(std::span<const Vec3> line);

/// How far each of evenly spaced places lies from the heel's end, anticlockwise, as a share of the line's
/// length.
[[nodiscard]] std::vector<double> round_ratios(std::span<const Vec3> line);

/// What is done at one place of the line.
struct PlaceWork {
  int zone{-1};  ///< index in Process::zones; -1: none
  bool left_out{false};
  TipPlacement placement;
  double speed_ratio{1};
};

/// Of each of evenly spaced places round the line, `spacing_mm` apart.
[[nodiscard]] std::vector<PlaceWork> work_along(std::span<const Vec3> line, double spacing_mm,
                                                const Process& process);

/// Places in a row that are worked in one go: `steps` steps from `first`, round the line.
struct Run {
  std::size_t first{0};
  std::size_t steps{0};
};

/// The line once round from `entry` with `overlap` steps more where nothing is left out; else its open
/// stretches in order, the one at or behind `entry` first.  Then the further passes of zones.
[[nodiscard]] std::vector<Run> runs_along(std::span<const PlaceWork> work, const Process& process,
                                          std::size_t entry, std::size_t overlap);

/// Its stretches as they lie on a shoe of this foot: mirrored where the process tells them on the other one.
/// As it is where the process, or `foot`, says nothing.
[[nodiscard]] Process on_foot(Process process, const std::string& foot);
/// It has stretches of one foot, so that nobody knows where they lie on a shoe whose foot nobody knows.
[[nodiscard]] bool needs_foot(const Process& process);

/// Of its pieces (`Process::only`) 1 mm in a row at least is left by the zones.  Empty for a process
/// without any.  Pre: the line passed check_line().
[[nodiscard]] std::vector<Check> check_pieces(const cloud::ClosedLine& line, const Process& process);

/// Of the process's zones, whatever `Process::only` keeps of them: heel and toe can be told apart, something
/// is left to work, and no run is too short for the tool to come to its speed.  Empty for a process without
/// zones.  Pre: the line passed check_line().
[[nodiscard]] std::vector<Check> check_zones(const cloud::ClosedLine& line, const Process& process);

}  // namespace biteline::path
