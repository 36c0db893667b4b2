// SPDX-License-Identifier: MIT
// biteline plan: a line becomes a checked tool path.
#include <cstdio>
#include <numbers>

#include "host/apps/biteline/command.hpp"
#include "host/cloud/ply.hpp"
#include "host/kinematics/calibration.hpp"
#include "host/report/report.hpp"
#include "host/robot/ur/script.hpp"
#include "host/trajectory/path_file.hpp"
#include "host/trajectory/plan.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double k_rad_per_deg = std::numbers::pi / 180;

struct Options {
  fs::path line, process, out, kinematics, cloud;
  std::string robot;
  std::vector<double> base_at{0, 0, 0, 0};  // x y z [mm], yaw [deg]
  double table_z_mm{0};
};

Result<trajectory::PlanRequest> read_request(const Options& options) {
  trajectory::PlanRequest request;
  BITELINE_ASSIGN(request.arm, kinematics::arm_model(options.robot));
  if (!options.kinematics.empty()) {
    BITELINE_ASSIGN(request.arm, kinematics::with_calibration(request.arm, options.kinematics));
  }
  BITELINE_ASSIGN(request.process, trajectory::read_process(options.process));
  BITELINE_ASSIGN(request.line, line::read_line(options.line));
  if (!options.cloud.empty()) {
    BITELINE_ASSIGN(cloud::PointCloud cloud, cloud::read_cloud(options.cloud));
    request.cloud = std::move(cloud.points);
  }
  request.T_line_base = geometry::make_se3(
      Eigen::Quaterniond{Eigen::AngleAxisd(options.base_at[3] * k_rad_per_deg, Vec3::UnitZ())},
      Vec3{options.base_at[0], options.base_at[1], options.base_at[2]});
  request.table_z_mm = options.table_z_mm;
  return request;
}

ordered_json as_json(const trajectory::Check& check) {
  ordered_json out{{"name", check.name},
                   {"passed", check.passed},
                   {"value", check.value},
                   {"limit", check.limit},
                   {"unit", check.unit}};
  if (check.arc_mm >= 0) out["at_mm"] = check.arc_mm;
  if (!check.detail.empty()) out["detail"] = check.detail;
  return out;
}

ordered_json as_json(const trajectory::Remedy& remedy) {
  ordered_json out = ordered_json::object();
  if (remedy.move_shoe_base)
    out["move_shoe_mm"] = {remedy.move_shoe_base->x(), remedy.move_shoe_base->y(),
                           remedy.move_shoe_base->z()};
  if (remedy.tilt_rad) out["tilt_deg"] = *remedy.tilt_rad / k_rad_per_deg;
  return out;
}

void fill_report(report::Report& report, const trajectory::PlanRequest& request,
                 const trajectory::PlanOutcome& outcome) {
  ordered_json& fields = report.fields;
  fields["robot"] = request.arm.name;
  fields["calibrated"] = request.arm.calibrated;
  fields["process"] = request.process.name;
  fields["covered_width_mm"] = trajectory::covered_width_mm(request.process);
  fields["line_length_mm"] = line::length_mm(request.line);
  fields["seam_at_mm"] = outcome.tool_path.seam_arc_mm;
  fields["checks"] = ordered_json::array();
  for (const trajectory::Check& check : outcome.checks) fields["checks"].push_back(as_json(check));
  if (outcome.path) {
    fields["points"] = outcome.path->path().waypoints.size();
    fields["duration_s"] = outcome.path->duration_s();
    return;
  }
  report.refuse(outcome.reason);
  if (outcome.blockage.what != trajectory::Obstacle::None) {
    fields["blocked_at_mm"] = outcome.blockage.arc_mm;
    fields["blocked_by"] = outcome.blockage.detail;
    fields["what_would_help"] = as_json(outcome.remedy);
  }
}

/// What an earlier run left: a refused plan leaves no path behind.
void remove_results(const fs::path& folder) {
  for (const char* name : {"path.csv", "path.script", "tracking.html"}) {
    std::error_code ignored;  // nothing there is what is wanted
    fs::remove(folder / name, ignored);
  }
}

Result<ExitStatus> run_plan(const Options& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const trajectory::PlanRequest request,
                  report.timed("read", [&] { return read_request(options); }));
  BITELINE_TRY(report::prepare_folder(options.out));
  remove_results(options.out);
  const trajectory::PlanOutcome outcome = report.timed("plan", [&] { return trajectory::plan(request); });
  fill_report(report, request, outcome);
  if (outcome.path) {
    BITELINE_TRY(report.timed("write", [&]() -> Result<void> {
      BITELINE_TRY(trajectory::write_path(options.out / "path.csv", *outcome.path));
      return report::write_file_atomically(options.out / "path.script", robot::ur::urscript(*outcome.path));
    }));
  }
  BITELINE_TRY(report.write(options.out));

  if (global.json) {
    std::printf("%s\n", report.fields.dump(2).c_str());
  } else if (outcome.path) {
    if (!global.quiet) {
      std::printf("%s follows the line in %.1f s, %zu points: %s\n", request.arm.name.c_str(),
                  outcome.path->duration_s(), outcome.path->path().waypoints.size(), options.out.c_str());
    }
  } else {
    std::fprintf(stderr, "biteline: refused: %s\n", outcome.reason.c_str());
  }
  return outcome.path ? ExitStatus::Done : ExitStatus::Refused;
}

}  // namespace

void add_plan(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("plan", "Plan a checked tool path along a line");
  command->add_option("LINE", options->line, "line.csv")->required();
  command->add_option("--robot", options->robot, "UR3e, UR5e, UR10e, UR3, UR5 or UR10")->required();
  command->add_option("--process", options->process, "Process YAML: tool, placement, motion")->required();
  command->add_option("--out", options->out, "Folder for path.csv, path.script, report.json")->required();
  command->add_option("--kinematics", options->kinematics,
                      "The arm's factory calibration (YAML of the ROS extractor)");
  command
      ->add_option("--base-at", options->base_at,
                   "Place of the arm's base in the line's frame: x y z [mm] yaw [deg]")
      ->expected(4);
  command->add_option("--table-z", options->table_z_mm, "Height of the table in the line's frame [mm]");
  command->add_option("--cloud", options->cloud,
                      "The shoe's cloud for collisions; without it the shoe is guessed from the line");
  command->callback([options, &context] {
    context.run = [options, &context] { return run_plan(*options, context.options); };
  });
}

}  // namespace biteline::app
