// SPDX-License-Identifier: MIT
#include "host/records/results/mended_result.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <string_view>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "common/system/file.hpp"
#include "host/cloud/flagged.hpp"
#include "host/cloud/ply.hpp"
#include "host/records/results/line_uncertainty.hpp"
#include "host/records/results/plan_result.hpp"
#include "host/records/results/view/alternatives.hpp"
#include "host/records/results/view/page_parts.hpp"
#include "host/records/results/view/view_data.hpp"
#include "host/records/results/view/weak_stretches.hpp"
#include "host/report/page.hpp"
#include "host/robot/path/checks/line_check.hpp"

namespace biteline::results {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Text = FixedText<240>;

std::string utc_now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm parts{};
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&seconds, &parts));
  return text;
}

/// The result's report as it was found; an empty object where there is none.
Json found_report(const fs::path& scan) {
  std::error_code error;
  const fs::path kept = scan / edit::found_report();
  const Result<std::string> text =
      read_regular_file(fs::exists(kept, error) ? kept : scan / "report.json", k_most_settings_bytes);
  Json json = text ? Json::parse(*text, nullptr, false) : Json{};
  return json.is_object() ? json : Json::object();
}

std::string text_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string{};
}

/// That the whole line is the bite line.  Of one that was found no hand says more; of another one its points
/// do, by the hand's word and the creases that it lies on.
double confidence_of(const cloud::ClosedLine& line, const Json& found) {
  const double held = 1 - cloud::flagged_of(line).all();
  const auto confidence = found.find("confidence");
  if (text_of(found, "status") == "ok" && confidence != found.end() && confidence->is_number())
    return std::min(confidence->get<double>(), held);
  double sum = 0;
  for (const cloud::LinePoint& point : line.points) sum += point.confidence;
  return std::min(sum / static_cast<double>(line.points.size()), held);
}

/// A hand can say where the line runs on what was seen, and not that what was seen is the shoe as it stood.
bool hand_may_settle(const Json& found) {
  using bite_line::Refused;
  if (text_of(found, "status") != "refused") return true;
  const std::string code = text_of(found, "reason_code");
  return std::ranges::any_of(bite_line::refusal_table(Refused{}), [&](const auto& row) {
    return row.name == code && row.code != Refused::DoesNotClose;
  });
}

/// Why a mended line is none to be worked: refused, or for review (StillUnsure).
std::optional<edit::Refusal> judge(const cloud::ClosedLine& line, const Json& found) {
  if (!hand_may_settle(found)) {
    return edit::Refusal{
        edit::Refused::ScanUnusable,
        Text::format("the scan was refused, and no hand mends that: %s", text_of(found, "reason").c_str())
            .c_str()};
  }
  const cloud::Flagged flagged = cloud::flagged_of(line);
  if (flagged.too_much()) {
    return edit::Refusal{
        edit::Refused::StillUnsure,
        Text::format(
            "%.0f %% of the mended line's length is still unsure or has too much U95 (at most %.0f %%)",
            100 * flagged.all(), 100 * cloud::k_most_flagged_share)
            .c_str()};
  }
  for (const path::Check& check : path::check_line(line)) {
    if (check.passed) continue;
    return edit::Refusal{edit::Refused::LineCheck, Text::format("the mended line fails the check '%s': %s",
                                                                check.name.c_str(), check.detail.c_str())
                                                       .c_str()};
  }
  return std::nullopt;
}

/// A mended point is no surer than the surest place of the line that was found.
bool holds_head(const Json& found) {
  const Json holds = found.value("u95", Json()).is_object() ? found["u95"].value("holds", Json()) : Json();
  return std::find(holds.begin(), holds.end(), "poses") != holds.end();
}

/// What snapped, and by how much.
Json as_json(const std::vector<edit::Snap>& snaps) {
  Json rows = Json::array();
  for (const edit::Snap& snap : snaps) {
    rows.push_back({{"point_mm", {snap.wanted.x(), snap.wanted.y(), snap.wanted.z()}},
                    {"on_crease", snap.on_crease},
                    {"by_mm", snap.by_mm}});
  }
  return rows;
}

Json versions_json(const std::vector<edit::Version>& versions) {
  Json rows = Json::array();
  for (const edit::Version& version : versions) {
    Json row{{"version", version.version},
             {"time", version.time},
             {"who", version.who},
             {"why", version.why},
             {"file", edit::line_file(version.version).string()}};
    std::string steps;
    for (const edit::Step& step : version.steps) steps += (steps.empty() ? "" : "; ") + edit::words_of(step);
    if (!steps.empty()) row["steps"] = steps;
    rows.push_back(std::move(row));
  }
  return rows;
}

Result<void> write_page(const fs::path& scan, const MendedScan& mended, const std::vector<WeakStretch>& weak,
                        const std::vector<edit::Version>& versions, const report::Report& report) {
  using report::Page;
  const bool refused = mended.status == ExitStatus::Refused;
  Page page{"Bite line", mended.words, refused ? Page::Mood::Refused : Page::Mood::Look};
  add_weak_stretches(page, weak);
  add_viewer(page, scan);
  page.heading("Versions");
  std::vector<std::vector<std::string>> rows;
  for (const edit::Version& version : versions) {
    std::string steps;
    for (const edit::Step& step : version.steps) steps += (steps.empty() ? "" : "; ") + edit::words_of(step);
    rows.push_back({std::to_string(version.version), version.time, version.who, version.why, steps});
  }
  page.table({"version", "time", "who", "why", "steps"}, rows);
  page.heading("Figures");
  page.figures(named_figures(report.fields));
  add_u95(page, report.fields);
  return page.write(scan / "index.html");
}

/// Everything that told of the line before tells of this one.
Result<void> write_result(const fs::path& scan, MendedScan& mended, const edit::Surface& surface,
                          const std::vector<edit::Version>& versions, report::Report& report) {
  const SE3& T_base_shoe = surface.T_base_shoe();
  const Json found = found_report(scan);
  for (const char* key : {"input", "sensor", "simulated", "sample", "scan", "devices", "messages_lost",
                          "points", "candidates", "closure_mm", "calibration_check"}) {
    if (found.contains(key)) report.fields[key] = found[key];
  }
  mended.confidence = confidence_of(mended.line, found);
  const std::optional<edit::Refusal> refusal = judge(mended.line, found);
  const bool review = refusal && refusal->code == edit::Refused::StillUnsure;
  if (review) report.review(*refusal);
  if (refusal && !review) report.refuse(*refusal);
  mended.status = report.status();

  double mended_share = 0;
  for (const cloud::LinePoint& point : mended.line.points) {
    if (point.source == cloud::PointSource::Mended)
      mended_share += 1 / static_cast<double>(mended.line.points.size());
  }
  const double length_mm = cloud::length_mm(mended.line);
  report.fields["length_mm"] = length_mm;
  report.fields["confidence"] = mended.confidence;
  report.fields["line_points"] = mended.line.points.size();
  report.fields["line_version"] = mended.version;
  report.fields["mended_mm"] = mended_share * length_mm;
  const std::vector<WeakStretch> weak = weak_stretches(mended.line, T_base_shoe);
  report.fields["weak_stretches"] =
      review ? as_open(weak, mended.line, surface.candidates()) : as_json(weak, length_mm);
  if (!mended.snaps.empty()) report.fields["points_by_hand"] = as_json(mended.snaps);
  // A hand's part is a bound, and so is that of poses and calibration: they are not weighed again.
  U95Parts parts = parts_of_found_line({.head = holds_head(found)});
  parts.holds.push_back("0.5 mm where a hand put the line beside any crease");
  report.fields["u95"] = u95_json(mended.line, parts);
  report.fields["versions"] = versions_json(versions);
  mended.words =
      Text::format("line mended: version %d, %.1f mm long, %.1f mm of it by hand, confidence %.2f%s%s",
                   mended.version, length_mm, mended_share * length_mm, mended.confidence,
                   review    ? "; review: "
                   : refusal ? "; refused: "
                             : "",
                   refusal ? refusal->reason.c_str() : "")
          .c_str();

  // A path of the line before is no path of this one.
  std::error_code error;
  if (fs::exists(scan / "path", error)) BITELINE_TRY(prepare_plan_folder(scan / "path"));
  BITELINE_TRY(cloud::write_line(scan / "line.csv", mended.line));
  report.stop_clock();
  ViewData view{.title = "Bite line",
                .summary = mended.words,
                .found = true,
                .report = report.fields,
                .cloud = &mended.cloud,
                .line = &mended.line,
                .T_base_shoe = T_base_shoe,
                .path_mm = {}};
  if (refusal) add_refusal(view.report, report::told(*refusal));
  BITELINE_TRY(write_view(scan, view));
  BITELINE_TRY(write_page(scan, mended, weak, versions, report));
  BITELINE_TRY(write_file_list(scan));
  return report.write(scan);
}

}  // namespace

Result<edit::OrRefusal<MendedScan>> mend_scan(const fs::path& scan, const MendOrder& order,
                                              report::Report& report) {
  using Outcome = edit::OrRefusal<MendedScan>;
  BITELINE_ASSIGN(std::vector<edit::Version> versions, edit::read_versions(scan));
  const int newest = versions.back().version;
  if (order.line_version.value_or(newest) != newest) {
    return fail(Errc::WrongState, "version %d was mended, and the newest is %d: look at that one first",
                *order.line_version, newest);
  }
  MendedScan mended;
  BITELINE_ASSIGN(mended.cloud, report.timed("read", [&] { return cloud::read_cloud(scan / "cloud.ply"); }));
  cloud::ClosedLine base;
  if (const Result<cloud::ClosedLine> line = edit::read_version(scan, newest)) {
    base = *line;
  } else if (line.error().code != Errc::FileNotFound && line.error().code != Errc::FileUnreadable) {
    return tl::unexpected<Error>{line.error()};
  }
  const edit::OrRefusal<edit::Surface> surface =
      report.timed("surface", [&] { return edit::Surface::of(mended.cloud); });
  if (!surface) return Outcome{tl::unexpected<edit::Refusal>(surface.error())};
  edit::Version made{.version = 0,
                     .time = utc_now(),
                     .who = order.who,
                     .why = order.why,
                     .mended = newest,
                     .steps = order.steps};
  for (edit::Step& step : made.steps) {
    const bool named = step.stretch.from_mm != 0 || step.stretch.to_mm != 0;
    if (step.kind == edit::Step::Kind::Through && !named)
      step.stretch = edit::stretch_about(base, step.points);
  }
  const edit::OldLine old_line = [&](int version) -> std::optional<cloud::ClosedLine> {
    Result<cloud::ClosedLine> line = edit::read_version(scan, version);
    return line ? std::optional{std::move(*line)} : std::nullopt;
  };
  edit::OrRefusal<cloud::ClosedLine> line = report.timed(
      "mend", [&] { return edit::mend(*surface, base, made.steps, old_line, order.by, &mended.snaps); });
  if (!line) return Outcome{tl::unexpected<edit::Refusal>(line.error())};
  mended.line = std::move(*line);
  BITELINE_ASSIGN(mended.version, edit::save_version(scan, made, mended.line));
  BITELINE_ASSIGN(versions, edit::read_versions(scan));
  BITELINE_TRY(write_result(scan, mended, *surface, versions, report));
  return Outcome{std::move(mended)};
}

}  // namespace biteline::results
