// SPDX-License-Identifier: MIT
#pragma once
/// \file What commands that plan a path ask of the cell: arm, table, fixture, tool.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/options/command.hpp"
#include "host/report/report.hpp"
#include "host/robot/path/plan.hpp"

namespace biteline::app {

struct CellOptions {
  std::filesystem::path kinematics, touches;
  std::string robot;
  std::vector<double> base_at{0, 0, 0, 0};  ///< x y z [mm], yaw [deg]
  std::vector<double> from_deg;
  std::optional<double> natural_hz;
  double table_z_mm{0};
  std::optional<double> fixture_z_mm;
  double fixture_beyond_mm{path::Fixture{}.beyond_mm};
};
void add_cell_options(options::Command& command, CellOptions& cell);

/// Arm, table, fixture and where the arm stands, into the request; the touched tip into its process, and into
/// `report` as `tool_touch`.  Pre: the request has its process.
[[nodiscard]] Result<void> take_cell(const CellOptions& cell, path::PlanRequest& request,
                                     report::Report& report);

}  // namespace biteline::app
