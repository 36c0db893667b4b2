// SPDX-License-Identifier: MIT
#include "host/robot/path/purge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/robot/path/checks/fixture.hpp"
#include "host/robot/path/entry.hpp"

namespace biteline::path {

bool purges(const std::optional<Flow>& flow, bool tool_off) {
  return flow && flow->purge_s > 0 && !tool_off;
}

std::optional<kinematics::Joints> purge_posture(const kinematics::ArmModel& arm, const Tool& tool,
                                                const Flow& flow, const kinematics::Joints& to_rad) {
  SE3 T_base_tcp = SE3::Identity();
  T_base_tcp.linear() = Eigen::AngleAxisd{std::numbers::pi, Vec3::UnitX()}.toRotationMatrix();
  T_base_tcp.translation() = flow.purge_at_base;
  const std::optional<kinematics::Joints> q_rad = nearest_posture(arm, T_base_tcp, tool, to_rad);
  const bool within = q_rad && (q_rad->array() >= arm.limits.minimum_rad.array()).all() &&
                      (q_rad->array() <= arm.limits.maximum_rad.array()).all();
  return within ? q_rad : std::nullopt;
}

Check check_purge(const Process& process, const Surroundings& surroundings) {
  constexpr double k_beside_mm = 30, k_above_mm = 2;
  const Vec3& at = process.flow->purge_at_base;
  const double fall_mm = std::max(0.0, at.z() - surroundings.table_z_mm);
  Check check{.name = "purge beside the shoe",
              .passed = true,
              .value = k_far_mm,
              .limit = k_beside_mm + fall_mm * std::tan(process.coverage.cone_rad / 2),
              .unit = "mm",
              .arc_mm = -1,
              .detail = {}};
  for (const Vec3& point : surroundings.shoe_points)
    check.value = std::min(check.value, (point - at).head<2>().norm());
  check.passed = check.value >= check.limit;
  if (!check.passed) check.detail = "what the tool purges falls on the shoe";
  if (at.z() - floor_mm(surroundings, at) >= k_above_mm) return check;
  check.passed = false;
  check.detail = "the tip is too near to the table where it purges";
  return check;
}

}  // namespace biteline::path
