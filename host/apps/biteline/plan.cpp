// SPDX-License-Identifier: MIT
// biteline plan: a line becomes a checked tool path.
#include "common/config/sensor_yaml.hpp"
#include "common/core/fixed_text.hpp"
#include "common/options/command.hpp"
#include "host/apps/biteline/cloud_option.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/plan_options.hpp"
#include "host/records/results/coverage_result.hpp"
#include "host/records/results/plan_result.hpp"
#include "host/report/json_text.hpp"
#include "host/robot/path/scan_process.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using options::number;

struct PlanOptions {
  fs::path line, process, scan, out, cloud;
  cloud::Reading reading;
  CellOptions cell;
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
  BITELINE_ASSIGN(request.process, read_process(options, false));
  BITELINE_TRY(take_cell(options.cell, request, report));
  BITELINE_ASSIGN(request.line, cloud::read_line(options.line));
  if (!options.cloud.empty()) {
    BITELINE_ASSIGN(cloud::CloudFile file, cloud::read_cloud_file(options.cloud, options.reading));
    BITELINE_TRY(near_origin(file, options.cloud));
    report.fields["cloud_file"] = as_json(file, options.reading);
    request.cloud = std::move(file.cloud.points);
  }
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
  BITELINE_TRY(report.timed_aside(
      "coverage", [&] { return results::write_coverage(options.out, request, outcome, report); }));
  BITELINE_TRY(results::write_plan_result(options.out, request, outcome, report));
  const auto told = outcome.refusal ? std::optional{report::told(*outcome.refusal)} : std::nullopt;
  return tell_folder(report, global, summary(request, outcome, options.out), options.out, told,
                     "look at the path on the page; biteline-host --send sends one of a new scan");
}

}  // namespace

void add_plan(options::Command& app, Context& context) {
  auto options = std::make_shared<PlanOptions>();
  options::Command* command = app.add_subcommand("plan", "Plan a checked tool path along a line");
  command->add_option("LINE", options->line, "line.csv")->required();
  options::Command* work = command->add_option_group("work", "What is done along the line");
  work->add_option("--process", options->process, "Process YAML: tool, placement, motion");
  work->add_option("--scan", options->scan, "sensor.yaml: the path of a scan by this head");
  work->require_option(1);
  command->add_option("--spacing", options->spacing_mm, "With --scan: distance between profiles [mm]")
      ->check(number({.minimum = 0.05, .maximum = 5}, "mm"));
  command->add_option("--out", options->out, "Folder for path.csv, path.script, report.json")->required();
  add_cell_options(*command, options->cell);
  command->add_option("--cloud", options->cloud,
                      "The shoe's cloud for collisions; without it the shoe is guessed from the line");
  add_reading_options(*command, options->reading);
  command->callback([options, &context] {
    context.run = [options, &context] { return run_plan(*options, context.options); };
  });
}

}  // namespace biteline::app
