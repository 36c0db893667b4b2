// SPDX-License-Identifier: MIT
// biteline line edit, biteline line show: a found line put right by hand.
#include "host/apps/biteline/line_edit.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/core/fixed_text.hpp"
#include "common/options/command.hpp"
#include "common/system/user_name.hpp"
#include "host/records/results/mended_result.hpp"
#include "host/records/results/view/weak_stretches.hpp"
#include "host/report/file_lock.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using options::number;

struct LineEditOptions {
  fs::path scan;
  int candidate{0};
  std::vector<std::string> through;
  double from_mm{0}, to_mm{0};
  bool has_from{false}, has_to{false}, cut{false}, undo{false};
  int back_to{-1};
  std::string why, who;
};

/// "X,Y,Z" in base, mm.
Result<Vec3> read_point(const std::string& text) {
  Vec3 point = Vec3::Zero();
  const char* at = text.data();
  const char* end = at + text.size();
  for (int axis = 0; axis < 3; ++axis) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    const bool last = axis == 2;
    const bool whole = error == std::errc{} && (last ? next == end : next != end && *next == ',');
    if (!whole || !std::isfinite(value) || std::abs(value) > 1e5)
      return fail(Errc::InvalidArgument, "--through '%.60s': X,Y,Z in mm in the robot's base expected",
                  text.c_str());
    point[axis] = value;
    at = next + (last ? 0 : 1);
  }
  return point;
}

Result<std::vector<edit::Step>> steps_of(const LineEditOptions& options,
                                         const std::vector<edit::Version>& versions) {
  using Kind = edit::Step::Kind;
  std::vector<edit::Step> steps;
  if (options.back_to >= 0)
    steps.push_back({.kind = Kind::BackTo, .points = {}, .line_version = options.back_to});
  if (options.undo) {
    if (versions.back().version == 0)
      return fail(Errc::InvalidArgument, "--undo: nobody has mended this line");
    steps.push_back({.kind = Kind::BackTo, .points = {}, .line_version = versions.back().mended});
  }
  if (options.has_from != options.has_to)
    return fail(Errc::InvalidArgument, "--from and --to: both ends of the stretch expected");
  const edit::Stretch stretch{.from_mm = options.from_mm, .to_mm = options.to_mm};
  const bool alone = options.candidate > 0 && options.through.empty() && !options.cut;
  if (options.candidate > 0)
    steps.push_back({.kind = Kind::Candidate,
                     .candidate = options.candidate,
                     .stretch = alone ? stretch : edit::Stretch{},
                     .points = {}});
  if (options.cut) {
    if (!options.has_from) return fail(Errc::InvalidArgument, "--cut: --from and --to expected");
    steps.push_back({.kind = Kind::Cut, .stretch = stretch, .points = {}});
  } else if (!options.through.empty() || (options.has_from && !alone)) {
    edit::Step step{.kind = Kind::Through, .stretch = stretch, .points = {}};
    for (const std::string& text : options.through) {
      BITELINE_ASSIGN(const Vec3 point, read_point(text));
      step.points.push_back(point);
    }
    steps.push_back(std::move(step));
  }
  if (steps.empty()) {
    return fail(Errc::InvalidArgument,
                "what to mend: --candidate, --through, --from and --to, --cut, --undo or --back-to expected");
  }
  return steps;
}

/// A service that runs remembers what waits for a person, and with which line: it is asked instead.
Result<void> no_service_holds(const fs::path& scan) {
  const fs::path lock = (fs::absolute(scan) / "..").lexically_normal() / "biteline-host.lock";
  std::error_code error;
  if (!fs::exists(lock, error)) return {};
  const Result<report::FileLock> held = report::FileLock::take(lock, "biteline line edit");
  if (held) return {};
  return fail(Errc::PeerRefused, "%.200s; mend the line on its page", to_line(held.error()).c_str());
}

Result<ExitStatus> edit(const LineEditOptions& options, const GlobalOptions& global) {
  BITELINE_TRY(no_service_holds(options.scan));
  report::Report report;
  BITELINE_ASSIGN(const std::vector<edit::Version> versions, edit::read_versions(options.scan));
  results::MendOrder order{
      .steps = {}, .who = options.who.empty() ? user_name() : options.who, .why = options.why};
  BITELINE_ASSIGN(order.steps, steps_of(options, versions));
  BITELINE_ASSIGN(const edit::OrRefusal<results::MendedScan> mended,
                  results::mend_scan(options.scan, order, report));
  if (!mended) {
    // Nothing was written: the result stands as it was.
    report.refuse(mended.error());
    return tell(report, global, "biteline: refused, nothing was changed: " + mended.error().reason);
  }
  return tell(report, global, "biteline: " + mended->words);
}

std::string words_of(const edit::Version& version) {
  std::string steps;
  for (const edit::Step& step : version.steps) steps += (steps.empty() ? "" : "; ") + edit::words_of(step);
  return FixedText<1000>::format("%3d  %-20s  %-12s  %s%s%s", version.version,
                                 version.time.empty() ? "-" : version.time.c_str(), version.who.c_str(),
                                 steps.c_str(), version.why.empty() ? "" : ": ", version.why.c_str())
      .c_str();
}

Result<ExitStatus> show(const LineEditOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const std::vector<edit::Version> versions, edit::read_versions(options.scan));
  const Result<cloud::ClosedLine> line = edit::read_version(options.scan, versions.back().version);
  std::string words;
  if (line) {
    const std::vector<results::WeakStretch> weak = results::weak_stretches(*line, SE3::Identity());
    double mended = 0;
    for (const cloud::LinePoint& point : line->points)
      mended += point.source == cloud::PointSource::Mended ? 1 : 0;
    const double length_mm = cloud::length_mm(*line);
    const double mended_mm = length_mm * mended / static_cast<double>(line->points.size());
    report.fields["length_mm"] = length_mm;
    report.fields["mended_mm"] = mended_mm;
    words = FixedText<200>::format("%.1f mm long, %zu points, %.1f mm by hand, %zu weak stretches", length_mm,
                                   line->points.size(), mended_mm, weak.size())
                .c_str();
    for (const results::WeakStretch& stretch : weak) {
      words += FixedText<160>::format("\n  weak from %.1f to %.1f mm: U95 %.2f mm, confidence %.2f",
                                      stretch.from_mm, stretch.from_mm + stretch.length_mm, stretch.u95_mm,
                                      stretch.least_confidence)
                   .c_str();
    }
  } else {
    words = "no line: the scan was refused; a candidate may be taken";
  }
  report.fields["line_version"] = versions.back().version;
  report.fields["versions"] = nlohmann::ordered_json::array();
  for (const edit::Version& version : versions) {
    words += "\n" + words_of(version);
    report.fields["versions"].push_back(
        {{"version", version.version}, {"time", version.time}, {"who", version.who}, {"why", version.why}});
  }
  return tell(report, {.quiet = false, .json = global.json}, words);
}

}  // namespace

void add_line_edit(options::Command& line, Context& context) {
  auto options = std::make_shared<LineEditOptions>();
  options::Command* edit_command = line.add_subcommand(
      "edit", "Mend the line of a scan; each mend is a new version, and what was found stays");
  edit_command->add_option("SCAN", options->scan, "The scan's folder: cloud.ply and report.json")->required();
  edit_command
      ->add_option("--candidate", options->candidate,
                   "Take this candidate of the report, counted from 1, the line as found; with --from and "
                   "--to over that stretch")
      ->check(options::whole_number(1, 99));
  edit_command
      ->add_option(
          "--through", options->through,
          "Lead the line through this point, X,Y,Z in mm in the robot's base; may stand several times")
      ->allow_extra_args(false);
  auto* from = edit_command->add_option(
      "--from", options->from_mm,
      "Where the stretch begins, along the line [mm]; default: 20 mm before the points");
  auto* to =
      edit_command->add_option("--to", options->to_mm, "Where it ends [mm]; alone with --from: found again");
  for (options::Option* end : {from, to}) end->check(number({.minimum = 0, .maximum = 5000}, "mm"));
  edit_command->add_flag("--cut", options->cut, "Take out what lies between --from and --to, and bridge it");
  edit_command->add_flag("--undo", options->undo, "Back to the version that was mended last");
  edit_command->add_option("--back-to", options->back_to, "Back to this version; 0: as found")
      ->check(options::whole_number(0, 10'000));
  edit_command->add_option("--why", options->why, "In a few words; kept with the version")->required();
  edit_command->add_option("--who", options->who, "Whose hand it is; default: this user");
  edit_command->callback([options, from, to, &context] {
    options->has_from = from->count() > 0;
    options->has_to = to->count() > 0;
    context.run = [options, &context] { return edit(*options, context.options); };
  });

  options::Command* show_command =
      line.add_subcommand("show", "A scan's line: weak stretches, and its versions");
  show_command->add_option("SCAN", options->scan, "The scan's folder")->required();
  show_command->callback(
      [options, &context] { context.run = [options, &context] { return show(*options, context.options); }; });
}

}  // namespace biteline::app
