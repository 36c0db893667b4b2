// SPDX-License-Identifier: MIT
#pragma once
/// \file Line, process and arm in; a checked path or a reason and a way out.

#include "host/robot/path/checks/checked_path.hpp"
#include "host/robot/path/checks/fixture.hpp"
#include "host/robot/path/mounted.hpp"
#include "host/robot/path/refused.hpp"

namespace biteline::path {

struct PlanRequest {
  cloud::ClosedLine line;  ///< in the frame it was measured in
  Process process;
  kinematics::ArmModel arm;
  SE3 T_line_base{SE3::Identity()};  ///< the planning arm's base in that frame
  double table_z_mm{0};              ///< in the line's frame
  std::optional<Fixture> fixture{};  ///< none: the shoe stands on the table
  ShoeGuess shoe;
  std::optional<kinematics::Joints>
      from_rad{};  ///< where the arm stands before; then its way there is found and checked
  std::optional<kinematics::Joints>
      near_rad{};  ///< about where the arm will stand before, if `from_rad` is not known: a wish
  std::vector<Eigen::Vector3f> cloud;  ///< of the shoe, in the line's frame; empty: guessed from the line
  double least_tip_to_shoe_mm{0};      ///< of the tip along the line; 0: it works on the shoe
  bool tool_off{false};                ///< the output is switched off, and never on
  Mounted mounted{};                   ///< what was taught at the cell; a process made for another is refused
  bool seek_remedy{true};              ///< of a path that is refused; dozens of trials
};

/// What would make a refused path possible; found by trying.
struct Remedy {
  std::optional<Vec3> move_shoe_base;  ///< mm, in the arm's base
  std::optional<double> tilt_rad;      ///< the process's tilt instead
};

struct PlanOutcome {
  std::vector<Check> checks;        ///< of the line, then of the path
  std::optional<CheckedPath> path;  ///< present when everything passed
  std::optional<Refusal> refusal;   ///< when not
  Blockage blockage;
  Remedy remedy;
  ToolPath tool_path;         ///< of `path`; when refused, of the first try
  Surroundings surroundings;  ///< in the arm's base: what collisions were checked against

  /// One plain sentence when there is no path.
  [[nodiscard]] std::string reason() const { return refusal ? refusal->reason : std::string{}; }
};

/// Check the tool, then the line; then for each place to enter it, the least harmful first: tool frames,
/// joints along the whole path at once, speeds, check of the path; the first that passes is taken.
[[nodiscard]] PlanOutcome plan(const PlanRequest& request);

/// The checks' failures as one sentence; empty when all passed.
[[nodiscard]] std::string failures(const std::vector<Check>& checks);

}  // namespace biteline::path
