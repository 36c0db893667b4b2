// SPDX-License-Identifier: MIT
// biteline inspect: what a process did along a line, by a scan before it and a scan after it.
#include <algorithm>
#include <memory>
#include <optional>

#include "common/core/fixed_text.hpp"
#include "common/options/command.hpp"
#include "host/apps/biteline/cloud_option.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/inspect_files.hpp"
#include "host/apps/biteline/rework_files.hpp"
#include "host/geometry/closed_curve.hpp"
#include "host/intake/session_run.hpp"
#include "host/records/digest/digest.hpp"
#include "host/records/report/progress.hpp"
#include "host/robot/path/zones.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

struct InspectOptions {
  fs::path first, second, process, out;
  std::string foot;
  std::optional<double> offset_mm, width_mm;
  double tolerance_mm{second_look::PlannedBand{}.tolerance_mm};
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

/// Parts of the line that the process leaves out.
std::vector<second_look::Arc> left_out_of(const cloud::ClosedLine& line, const path::Process& process) {
  constexpr double k_spacing_mm = 1;
  const geometry::ArcLength arc{line.points.size(), [&](std::size_t i) { return line.points[i].position; }};
  std::vector<Vec3> places;
  for (const geometry::OnCurve& on : arc.even(arc.count_for(k_spacing_mm)))
    places.push_back(on.between(line.points[on.before].position, line.points[on.after].position));
  const double step_mm = arc.total_mm() / static_cast<double>(places.size());
  std::vector<second_look::Arc> arcs;
  bool before = false;
  const std::vector<path::PlaceWork> work = path::work_along(places, step_mm, process);
  for (std::size_t i = 0; i < work.size(); ++i) {
    const double at_mm = static_cast<double>(i) * step_mm;
    if (work[i].left_out && !before) arcs.push_back({.from_mm = at_mm, .to_mm = at_mm});
    if (work[i].left_out) arcs.back().to_mm = at_mm + step_mm;
    before = work[i].left_out;
  }
  return arcs;
}

Result<second_look::PlannedBand> plan_of(const InspectOptions& options, const cloud::ClosedLine& line) {
  BITELINE_ASSIGN(path::Process process, path::read_process(options.process));
  if (path::needs_foot(process) && options.foot.empty())
    return fail(Errc::InvalidArgument, "%s has stretches of one foot: --foot left or right expected",
                options.process.c_str());
  process = path::on_foot(std::move(process), options.foot);
  for (const path::Zone& zone : process.zones) {
    if (zone.up_by_mm != 0 || zone.outward_by_mm != 0)
      return fail(Errc::InvalidArgument, "zone '%s' moves the band, and one band is compared all round",
                  zone.name.c_str());
  }
  for (const path::Check& check : path::check_zones(line, process)) {
    if (!check.passed) return fail(Errc::BadValue, "%s: %s", options.process.c_str(), check.detail.c_str());
  }
  const double middle_mm = options.offset_mm.value_or(process.placement.up_mm),
               width_mm = options.width_mm.value_or(path::covered_width_mm(process));
  if (!(width_mm > 0))
    return fail(Errc::InvalidArgument, "%s tells no width: --width-mm expected", options.process.c_str());
  return second_look::PlannedBand{.low_mm = middle_mm - width_mm / 2,
                                  .high_mm = middle_mm + width_mm / 2,
                                  .left_out = left_out_of(line, process),
                                  .tolerance_mm = options.tolerance_mm};
}

std::string summary(const second_look::Findings& findings) {
  if (findings.refusal) return "refused: " + findings.refusal->reason;
  std::string words =
      FixedText<160>::format("worked: %.0f mm of %.0f mm", findings.worked_mm, findings.planned_mm).c_str();
  if (findings.unclear_mm > 0)
    words += FixedText<80>::format("; of %.0f mm nobody can tell", findings.unclear_mm).view();
  for (const second_look::Fault& fault : findings.faults)
    words += FixedText<120>::format("\n%s from %.1f to %.1f mm, across %.1f to %.1f mm",
                                    second_look::name_of(fault.kind), fault.along.from_mm, fault.along.to_mm,
                                    fault.low_mm, fault.high_mm)
                 .view();
  return words;
}

/// Done, to be looked at by a person, or refused.
void judge(const second_look::Findings& findings, bool reworked, report::Report& report) {
  using second_look::Settle;
  if (findings.refusal) return report.refuse(*findings.refusal);
  if (!findings.faults.empty())
    return report.review(report::Refusal<Settle>{
        .code = reworked ? Settle::StillFaulty : Settle::WorkFaulty,
        .reason = FixedText<160>::format("%zu faults along %.0f mm of work%s", findings.faults.size(),
                                         findings.planned_mm,
                                         reworked ? ", after it was worked once more: a person decides" : "")
                      .c_str()});
  if (findings.unclear_mm > 0)
    report.review(report::Refusal<Settle>{
        .code = Settle::WorkUnsure,
        .reason =
            FixedText<120>::format("of %.0f mm nobody can tell whether they are worked", findings.unclear_mm)
                .c_str()});
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
  report.fields["first"] = options.first.filename().string();
  report.fields["second"] = options.second.filename().string();
  BITELINE_ASSIGN(report.fields["line_sha256"], digest_of_file(options.first / "line.csv"));
  BITELINE_ASSIGN(report.fields["process_sha256"], digest_of_file(options.process));
  report.fields["foot"] = options.foot;
  BITELINE_ASSIGN(const std::size_t reworks, reworks_of(options.first));
  report.fields["reworks"] = reworks;
  report.fields["work"] = as_json(findings, plan);
  if (!findings.places.empty()) {
    BITELINE_TRY(report::write_file_atomically(options.out / "band.csv", band_table(findings)));
    BITELINE_TRY(report::write_file_atomically(options.out / "band.svg", band_picture(findings, plan)));
  }
  judge(findings, reworks > 0, report);
  BITELINE_TRY(report.write(options.out));
  return tell(report, global, summary(findings));
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
  command->add_option("--tolerance-mm", options->tolerance_mm, "An edge farther off is a fault")
      ->check(options::number({.minimum = 0.1, .maximum = 20}, "mm"))
      ->capture_default_str();
  command->callback([options, &context] {
    context.run = [options, &context] { return inspect(*options, context.options); };
  });
}

}  // namespace biteline::app
