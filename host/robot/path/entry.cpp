// SPDX-License-Identifier: MIT
#include "host/robot/path/entry.hpp"

#include <algorithm>

#include "host/robot/kinematics/inverse.hpp"
#include "host/robot/path/checks/way_there.hpp"

namespace biteline::path {
namespace {

using kinematics::Joints;

// The straight stretches of a shoe's two sides harm alike to some hundredths, toe and heel by 0.3 and more;
// the far side is 0.2 to 0.5 rad farther away.
constexpr double k_harm_per_rad = 0.3;
constexpr double k_out_of_reach_rad = 6;

double farthest_rad(const Joints& from_rad, const Joints& to_rad) {
  return (to_rad - from_rad).cwiseAbs().maxCoeff();
}

}  // namespace

std::optional<Joints> nearest_posture(const kinematics::ArmModel& arm, const SE3& T_base_tcp,
                                      const Tool& tool, const Joints& from_rad) {
  constexpr int k_turns = 12;
  const int turns = tool.free_turn_rad > 0 ? k_turns : 0;
  std::optional<Joints> nearest_rad;
  for (int turn = 0; turn <= turns; ++turn) {
    const double turn_rad = turns > 0 ? tool.free_turn_rad * (2.0 * turn / turns - 1) : 0;
    const SE3 T_base_flange =
        T_base_tcp * Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()) * tool.T_flange_tcp.inverse();
    for (const kinematics::Solution& solution :
         kinematics::inverse(arm, T_base_flange, {.q6_hint_rad = from_rad[5], .search_folds = false})) {
      const Joints q_rad = kinematics::nearest_turns(solution.q_rad, from_rad, arm.limits, 0);
      if (!nearest_rad || farthest_rad(from_rad, q_rad) < farthest_rad(from_rad, *nearest_rad))
        nearest_rad = q_rad;
    }
  }
  return nearest_rad;
}

std::vector<Seam> seams_in_order(const cloud::ClosedLine& line, const Process& process,
                                 const kinematics::ArmModel& arm, const std::optional<Joints>& from_rad) {
  std::vector<Seam> seams = seam_candidates(line, process);
  if (!from_rad) return seams;
  for (Seam& seam : seams) {
    const std::optional<Joints> begins_rad =
        nearest_posture(arm, seam.T_base_begins, process.tool, *from_rad);
    seam.harm += k_harm_per_rad * (begins_rad ? farthest_rad(*from_rad, *begins_rad) : k_out_of_reach_rad);
  }
  std::ranges::sort(seams, {}, &Seam::harm);
  return seams;
}

double farther_back_mm(const Seam& seam, const Tool& tool, const kinematics::ArmModel& arm,
                       const CollisionModel& collisions, const Joints& from_rad) {
  for (const double back_mm : {0.0, 15.0, 30.0, 50.0}) {
    const SE3 T_base_begins = seam.T_base_begins * Eigen::Translation3d{0, 0, -back_mm};
    const std::optional<Joints> begins_rad = nearest_posture(arm, T_base_begins, tool, from_rad);
    if (begins_rad && is_free_way(from_rad, *begins_rad, arm, collisions)) return back_mm;
  }
  return 0;
}

}  // namespace biteline::path
