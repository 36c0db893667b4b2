// SPDX-License-Identifier: MIT
// biteline plan: a line becomes a checked tool path.
#include <numbers>

#include "common/config/sensor_yaml.hpp"
#include "common/core/fixed_text.hpp"
#include "common/options/command.hpp"
#include "host/apps/biteline/cloud_option.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/records/report/json_text.hpp"
#include "host/records/results/plan_result.hpp"
#include "host/robot/kinematics/calibration.hpp"
#include "host/robot/kinematics/tool_touch.hpp"
#include "host/robot/path/scan_process.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using options::number;

constexpr double k_rad_per_deg = std::numbers::pi / 180;

struct PlanOptions {
  fs::path line, process, scan, out, kinematics, cloud, touches;
  cloud::Reading reading;
  std::string robot;
  std::vector<double> base_at{0, 0, 0, 0};  // x y z [mm], yaw [deg]
  std::vector<double> from_deg;
  std::optional<double> natural_hz;
  double table_z_mm{0};
  std::optional<double> fixture_z_mm;
  double fixture_beyond_mm{path::Fixture{}.beyond_mm};
  double spacing_mm{1};
};

/// The process file, or the scan by the head of --scan.
Result<path::Process> read_process(const PlanOptions& options, bool turned) {
  if (options.scan.empty()) return path::read_process(options.process);
  BITELINE_ASSIGN(const geometry::SensorModel sensor, config::read_sensor_yaml(options.scan));
  path::ScanSettings settings{.spacing_mm = options.spacing_mm, .turned = turned};
  if (sensor.rate_hz) settings.rate_hz = *sensor.rate_hz;
  return path::scan_process(sensor, settings);
}

Result<path::PlanRequest> read_request(const PlanOptions& options, report::Report& report) {
  path::PlanRequest request;
  BITELINE_ASSIGN(request.arm, kinematics::arm_model(options.robot));
  if (!options.kinematics.empty()) {
    BITELINE_ASSIGN(request.arm, kinematics::with_calibration(request.arm, options.kinematics));
  }
  if (options.natural_hz) request.arm.give = kinematics::joint_give(*options.natural_hz, true);
  BITELINE_ASSIGN(request.process, read_process(options, false));
  if (!options.touches.empty()) {
    BITELINE_ASSIGN(const std::vector<SE3> touches, kinematics::read_touches(options.touches));
    BITELINE_ASSIGN(const kinematics::ToolTouch fit, kinematics::fit_tool_touch(touches, {}));
    request.process.tool.T_flange_tcp.translation() = fit.tip_flange;
    request.mounted.tip_u95_mm = fit.u95_mm;
    report.fields["tool_touch"] = {{"touches", touches.size()},
                                   {"rms_mm", fit.rms_mm},
                                   {"sigma_mm", fit.sigma_mm.norm()},
                                   {"tip_mm", {fit.tip_flange.x(), fit.tip_flange.y(), fit.tip_flange.z()}}};
  }
  BITELINE_ASSIGN(request.line, cloud::read_line(options.line));
  if (!options.cloud.empty()) {
    BITELINE_ASSIGN(cloud::CloudFile file, cloud::read_cloud_file(options.cloud, options.reading));
    BITELINE_TRY(near_origin(file, options.cloud));
    report.fields["cloud_file"] = as_json(file, options.reading);
    request.cloud = std::move(file.cloud.points);
  }
  request.T_line_base = geometry::make_se3(
      Eigen::Quaterniond{Eigen::AngleAxisd(options.base_at[3] * k_rad_per_deg, Vec3::UnitZ())},
      Vec3{options.base_at[0], options.base_at[1], options.base_at[2]});
  request.table_z_mm = options.table_z_mm;
  if (options.fixture_z_mm)
    request.fixture =
        path::Fixture{.top_z_mm = *options.fixture_z_mm, .beyond_mm = options.fixture_beyond_mm};
  if (!options.from_deg.empty())
    request.from_rad = k_rad_per_deg * Eigen::Map<const kinematics::Joints>(options.from_deg.data());
  return request;
}

std::string summary(const path::PlanRequest& request, const path::PlanOutcome& outcome, const fs::path& out) {
  if (!outcome.path) return "biteline: refused: " + outcome.reason();
  const std::string warning = results::uncertainty_warning(request, outcome);
  return FixedText<600>::format("%s follows the line in %.1f s, %zu points: %s%s%s", request.arm.name.c_str(),
                                outcome.path->duration_s(), outcome.path->path().waypoints.size(),
                                out.c_str(), warning.empty() ? "" : "; ", warning.c_str())
      .c_str();
}

Result<ExitStatus> run_plan(const PlanOptions& options, const GlobalOptions& global) {
  report::Report report;
  // Before anything can fail: whatever comes of this run, no path of an earlier one stands for it.
  BITELINE_TRY(results::prepare_plan_folder(options.out));
  BITELINE_ASSIGN(path::PlanRequest request,
                  report.timed("read", [&] { return read_request(options, report); }));
  path::PlanOutcome outcome = report.timed("plan", [&] { return path::plan(request); });
  if (!outcome.path && !options.scan.empty()) {
    // A head scans either way round; what the arm cannot do one way it may do the other.
    BITELINE_ASSIGN(request.process, read_process(options, true));
    path::PlanOutcome turned = report.timed("plan", [&] { return path::plan(request); });
    if (turned.path) outcome = std::move(turned);
  }
  BITELINE_TRY(results::write_plan_result(options.out, request, outcome, report));
  return tell(report, global, summary(request, outcome, options.out));
}

}  // namespace

void add_plan(options::Command& app, Context& context) {
  auto options = std::make_shared<PlanOptions>();
  options::Command* command = app.add_subcommand("plan", "Plan a checked tool path along a line");
  command->add_option("LINE", options->line, "line.csv")->required();
  command->add_option("--robot", options->robot, kinematics::known_arms())->required();
  options::Command* work = command->add_option_group("work", "What is done along the line");
  work->add_option("--process", options->process, "Process YAML: tool, placement, motion");
  work->add_option("--scan", options->scan, "sensor.yaml: the path of a scan by this head");
  work->require_option(1);
  command->add_option("--spacing", options->spacing_mm, "With --scan: distance between profiles [mm]")
      ->check(number({.minimum = 0.05, .maximum = 5}, "mm"));
  command->add_option("--out", options->out, "Folder for path.csv, path.script, report.json")->required();
  command->add_option("--kinematics", options->kinematics,
                      "The arm's factory calibration (YAML of the ROS extractor)");
  command
      ->add_option("--natural-hz", options->natural_hz,
                   "The softest joint's own frequency with the tool, where it was measured [Hz]; else 8")
      ->check(number({.minimum = 1, .maximum = 100}, "Hz"));
  command
      ->add_option("--base-at", options->base_at,
                   "Place of the arm's base in the line's frame: x y z [mm] yaw [deg]")
      ->check(number(k_plausible_mm, "mm, deg"))
      ->expected(4);
  command
      ->add_option("--from", options->from_deg,
                   "Joints where the arm stands before [deg]: its way to the path's beginning is checked too")
      ->check(number({.minimum = -720, .maximum = 720}, "deg"))
      ->expected(6);
  command->add_option("--touches", options->touches,
                      "The tool's tip from touching one point: poses of the flange (number, mm, quaternion)");
  command->add_option("--table-z", options->table_z_mm, "Height of the table in the line's frame [mm]")
      ->check(number(k_plausible_mm, "mm"));
  auto* fixture =
      command
          ->add_option(
              "--fixture-z", options->fixture_z_mm,
              "Where the shoe stands on a fixture: its top in the line's frame [mm]; else on the table")
          ->check(number(k_plausible_mm, "mm"));
  command
      ->add_option("--fixture-beyond", options->fixture_beyond_mm,
                   "How far the fixture stands out beyond the line, all round [mm]")
      ->check(number({.minimum = 0, .maximum = 500}, "mm"))
      ->needs(fixture)
      ->capture_default_str();
  command->add_option("--cloud", options->cloud,
                      "The shoe's cloud for collisions; without it the shoe is guessed from the line");
  add_reading_options(*command, options->reading);
  command->callback([options, &context] {
    context.run = [options, &context] { return run_plan(*options, context.options); };
  });
}

}  // namespace biteline::app
