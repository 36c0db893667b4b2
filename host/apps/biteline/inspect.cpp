// SPDX-License-Identifier: MIT
// biteline inspect: what a process did along a line, by a scan before it and a scan after it.
#include <algorithm>
#include <memory>
#include <optional>

#include "common/core/fixed_text.hpp"
#include "common/options/command.hpp"
#include "host/apps/biteline/cloud_option.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/intake/session_run.hpp"
#include "host/records/digest/digest.hpp"
#include "host/records/look/look_result.hpp"
#include "host/records/look/planned_band.hpp"
#include "host/records/look/rework_files.hpp"
#include "host/report/progress.hpp"
#include "host/robot/path/zones.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

struct InspectOptions {
  fs::path first, second, process, out;
  std::string foot;
  std::optional<double> offset_mm, width_mm, tolerance_mm;
};

Result<cloud::PointCloud> read_cloud_near(const fs::path& file) {
  BITELINE_ASSIGN(cloud::CloudFile read, cloud::read_cloud_file(file));
  BITELINE_TRY(near_origin(read, file));
  return std::move(read.cloud);
}

/// A session is replayed; of a result its cloud counts.
Result<cloud::PointCloud> read_second(const fs::path& path, const GlobalOptions& global) {
  if (!fs::is_directory(path)) return read_cloud_near(path);
  if (!fs::exists(path / "cam0")) return read_cloud_near(path / "cloud.ply");
  std::optional<report::Progress> progress;
  BITELINE_ASSIGN(intake::SessionRun run,
                  intake::run_sensor_on_session({.session = path,
                                                 .sensor_file = {},
                                                 .sensor_options = {},
                                                 .program = {},
                                                 .progress =
                                                     [&](std::size_t done, std::size_t total) {
                                                       if (!progress)
                                                         progress.emplace("profiles", total, global.quiet);
                                                       progress->set(done);
                                                     },
                                                 .on_profile = {}}));
  return std::move(run.cloud);
}

Result<second_look::PlannedBand> plan_of(const InspectOptions& options, const cloud::ClosedLine& line) {
  BITELINE_ASSIGN(path::Process process, path::read_process(options.process));
  if (path::needs_foot(process) && options.foot.empty())
    return fail(Errc::InvalidArgument, "%s has stretches of one foot: --foot left or right expected",
                options.process.c_str());
  process = path::on_foot(std::move(process), options.foot);
  if (!options.width_mm && !(path::covered_width_mm(process) > 0))
    return fail(Errc::InvalidArgument, "%s tells no width: --width-mm expected", options.process.c_str());
  return look::planned_band(
      line, process,
      {.offset_mm = options.offset_mm, .width_mm = options.width_mm, .tolerance_mm = options.tolerance_mm});
}

Result<ExitStatus> inspect(const InspectOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_TRY(report::prepare_folder(options.out));
  BITELINE_ASSIGN(const cloud::ClosedLine line, cloud::read_line(options.first / "line.csv"));
  BITELINE_ASSIGN(const second_look::PlannedBand plan, plan_of(options, line));
  BITELINE_ASSIGN(const cloud::PointCloud first,
                  report.timed("read", [&] { return read_cloud_near(options.first / "cloud.ply"); }));
  BITELINE_ASSIGN(const cloud::PointCloud second,
                  report.timed("scan", [&] { return read_second(options.second, global); }));
  const second_look::Findings findings =
      report.timed("compare", [&] { return second_look::look_again(first, second, line, plan); });
  look::LookOf of{.first = options.first.filename().string(),
                  .second = options.second.filename().string(),
                  .line_sha256 = {},
                  .process_sha256 = {},
                  .foot = options.foot};
  BITELINE_ASSIGN(of.line_sha256, digest_of_file(options.first / "line.csv"));
  BITELINE_ASSIGN(of.process_sha256, digest_of_file(options.process));
  BITELINE_ASSIGN(of.reworks, look::reworks_of(options.first));
  BITELINE_TRY(look::write_look_result(options.out, findings, plan, of, report));
  BITELINE_TRY(report.write(options.out));
  return tell(report, global, look::summary(findings));
}

}  // namespace

void add_inspect(options::Command& app, Context& context) {
  auto options = std::make_shared<InspectOptions>();
  options::Command* command = app.add_subcommand(
      "inspect",
      "See by a second scan what a process did along a line: what is missing, where its edges are");
  command->add_option("FIRST", options->first, "Folder of the scan before: cloud.ply and line.csv")
      ->required();
  command
      ->add_option("SECOND", options->second,
                   "The scan after, the shoe not moved: a session's folder, a result's folder, or a cloud")
      ->required();
  command->add_option("--process", options->process, "Process YAML: where the band is, and how wide")
      ->required();
  command->add_option("--out", options->out, "Folder for report.json, band.csv, band.svg")->required();
  command->add_option("--foot", options->foot, "Of the shoe, where the process has stretches of one foot")
      ->check(options::one_of({"left", "right"}))
      ->type_name("left|right");
  command
      ->add_option("--offset-mm", options->offset_mm,
                   "The band's middle above the line, on the surface; else as the process says")
      ->check(options::number({.minimum = -50, .maximum = 200}, "mm"));
  command
      ->add_option("--width-mm", options->width_mm,
                   "The band's width on the surface; else as the process says")
      ->check(options::number({.minimum = 1, .maximum = 200}, "mm"));
  command
      ->add_option("--tolerance-mm", options->tolerance_mm,
                   "An edge farther off is a fault; else as the process says")
      ->check(options::number({.minimum = 0.1, .maximum = 20}, "mm"));
  command->callback([options, &context] {
    context.run = [options, &context] { return inspect(*options, context.options); };
  });
}

}  // namespace biteline::app
