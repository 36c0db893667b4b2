// SPDX-License-Identifier: MIT
#include "host/apps/biteline/plan_options.hpp"

#include <numbers>

#include "host/robot/kinematics/calibration.hpp"
#include "host/robot/kinematics/tool_touch.hpp"

namespace biteline::app {
namespace {

using options::number;

Result<void> take_touches(const std::filesystem::path& file, path::PlanRequest& request,
                          report::Report& report) {
  BITELINE_ASSIGN(const std::vector<SE3> touches, kinematics::read_touches(file));
  BITELINE_ASSIGN(const kinematics::ToolTouch fit, kinematics::fit_tool_touch(touches, {}));
  request.process.tool.T_flange_tcp.translation() = fit.tip_flange;
  request.mounted.tip_u95_mm = fit.u95_mm;
  report.fields["tool_touch"] = {{"touches", touches.size()},
                                 {"rms_mm", fit.rms_mm},
                                 {"sigma_mm", fit.sigma_mm.norm()},
                                 {"tip_mm", {fit.tip_flange.x(), fit.tip_flange.y(), fit.tip_flange.z()}}};
  return {};
}

}  // namespace

Result<void> take_cell(const CellOptions& cell, path::PlanRequest& request, report::Report& report) {
  constexpr double k_rad_per_deg = std::numbers::pi / 180;
  BITELINE_ASSIGN(request.arm, kinematics::arm_model(cell.robot));
  if (!cell.kinematics.empty()) {
    BITELINE_ASSIGN(request.arm, kinematics::with_calibration(request.arm, cell.kinematics));
  }
  if (cell.natural_hz) request.arm.give = kinematics::joint_give(*cell.natural_hz, true);
  if (!cell.touches.empty()) BITELINE_TRY(take_touches(cell.touches, request, report));
  request.T_line_base = geometry::make_se3(
      Eigen::Quaterniond{Eigen::AngleAxisd(cell.base_at[3] * k_rad_per_deg, Vec3::UnitZ())},
      Vec3{cell.base_at[0], cell.base_at[1], cell.base_at[2]});
  request.table_z_mm = cell.table_z_mm;
  if (cell.fixture_z_mm)
    request.fixture = path::Fixture{.top_z_mm = *cell.fixture_z_mm, .beyond_mm = cell.fixture_beyond_mm};
  if (!cell.from_deg.empty())
    request.from_rad = k_rad_per_deg * Eigen::Map<const kinematics::Joints>(cell.from_deg.data());
  return {};
}

void add_cell_options(options::Command& command, CellOptions& cell) {
  command.add_option("--robot", cell.robot, kinematics::known_arms())->required();
  command.add_option("--kinematics", cell.kinematics,
                     "The arm's factory calibration (YAML of the ROS extractor)");
  command
      .add_option("--natural-hz", cell.natural_hz,
                  "The softest joint's own frequency with the tool, where it was measured [Hz]; else 8")
      ->check(number({.minimum = 1, .maximum = 100}, "Hz"));
  command
      .add_option("--base-at", cell.base_at,
                  "Place of the arm's base in the line's frame: x y z [mm] yaw [deg]")
      ->check(number(k_plausible_mm, "mm, deg"))
      ->expected(4);
  command
      .add_option("--from", cell.from_deg,
                  "Joints where the arm stands before [deg]: its way to the path's beginning is checked too")
      ->check(number({.minimum = -720, .maximum = 720}, "deg"))
      ->expected(6);
  command.add_option("--touches", cell.touches,
                     "The tool's tip from touching one point: poses of the flange (number, mm, quaternion)");
  command.add_option("--table-z", cell.table_z_mm, "Height of the table in the line's frame [mm]")
      ->check(number(k_plausible_mm, "mm"));
  auto* fixture =
      command
          .add_option(
              "--fixture-z", cell.fixture_z_mm,
              "Where the shoe stands on a fixture: its top in the line's frame [mm]; else on the table")
          ->check(number(k_plausible_mm, "mm"));
  command
      .add_option("--fixture-beyond", cell.fixture_beyond_mm,
                  "How far the fixture stands out beyond the line, all round [mm]")
      ->check(number({.minimum = 0, .maximum = 500}, "mm"))
      ->needs(fixture)
      ->capture_default_str();
}

}  // namespace biteline::app
