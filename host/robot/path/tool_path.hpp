// SPDX-License-Identifier: MIT
#pragma once
/// \file From the line to tool frames: where the tip goes, and how the tool stands.

#include <optional>
#include <vector>

#include "host/cloud/closed_line.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::path {

/// Travel: from one worked stretch to the next, along the line, drawn back and lifted, the tool off.
enum class Segment { Approach, Line, Retreat, Travel };
[[nodiscard]] const char* name_of(Segment segment);

struct ToolPoint {
  SE3 T_base_tcp;  ///< z along the tool's axis towards the shoe, x along the travel, before any free turn
  Segment segment{Segment::Line};
  double arc_mm{0};                ///< along the tip's path, from its beginning
  double curvature_per_mm{0};      ///< of the tip's path
  Vec3 line_base;                  ///< the point of the bite line it belongs to
  std::optional<double> u95_mm{};  ///< of the line, carried to the tip; on the line only, none: not known
  double speed_ratio{1};           ///< the tip's, of the process's speed along the line
  Vec3 press_base{Vec3::Zero()};   ///< against the surface's normal; on the line only, unit length
  double round_ratio{0};           ///< of the place on the line: of its length from the heel's end
};

struct ToolPath {
  std::vector<ToolPoint> points;
  double seam_arc_mm{0};  ///< along the line as given: where it is entered
  double spacing_mm{0};   ///< of the line's points, at least
  double standoff_mm{0};  ///< of the tip from what it works on
  /// How far the straight moves between the line's points, and the blends round them, leave the tip's way.
  double chord_error_mm{0};
  double chord_error_arc_mm{0};  ///< where, along the tip's path on the line
};

/// Lift, approach, the whole line once and its overlap, and away again; with zones (zones.hpp) or pieces
/// of its own (`Process::only`) each stretch so, and the way to the next one between.  Tool directions are
/// smoothed along the line (8 mm), so that noise of a normal does not shake the wrist; positions are not. The
/// first way in begins `farther_back_mm` farther back along the tool than the process asks.  Pre: the line
/// passed check_line() and check_zones().
[[nodiscard]] ToolPath make_tool_path(const cloud::ClosedLine& line, const Process& process,
                                      double seam_arc_mm, double farther_back_mm = 0);

/// A place where the line may be entered.
struct Seam {
  double arc_mm{0};   ///< along the line as given
  double harm{0};     ///< turns of the line there, rad, and nearness to the ends of the outline, 0 to 1
  SE3 T_base_begins;  ///< where a path from there begins, before any free turn
};

/// The least harmful first: one place for a start that the process fixes, else the best of eight sectors; of
/// a process of pieces of its own, the beginnings of these.
/// Pre: the line passed check_line() and check_zones().
[[nodiscard]] std::vector<Seam> seam_candidates(const cloud::ClosedLine& line, const Process& process);

}  // namespace biteline::path
