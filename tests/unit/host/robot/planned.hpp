// SPDX-License-Identifier: MIT
#pragma once
/// \file A checked path for tests: the made oval under a UR5e.

#include <map>
#include <string>

#include "host/trajectory/plan.hpp"
#include "tests/unit/host/trajectory/made_line.hpp"

namespace biteline::robot::test {

/// `process` is the file's name, e.g. "grind.yaml".  Planned once per executable.
inline const trajectory::CheckedPath& planned_path(const std::string& process) {
  static std::map<std::string, trajectory::CheckedPath> paths;
  const auto known = paths.find(process);
  if (known != paths.end()) return known->second;
  const trajectory::PlanRequest request{.line = trajectory::test::made_line(),
                                        .process = *trajectory::read_process(std::filesystem::path{BITELINE_PROCESSES} / process),
                                        .arm = *kinematics::arm_model("UR5e"),
                                        .T_line_base = SE3::Identity(),
                                        .table_z_mm = 40,
                                        .shoe = {},
                                        .cloud = {}};
  return paths.emplace(process, *trajectory::plan(request).path).first->second;
}

}  // namespace biteline::robot::test
