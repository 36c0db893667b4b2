// SPDX-License-Identifier: MIT
#include "host/records/results/plan_result.hpp"

#include <numbers>

#include "common/core/fixed_text.hpp"
#include "host/records/results/tracking_page/tracking_page.hpp"
#include "host/records/results/view/page_parts.hpp"
#include "host/records/results/view/view_data.hpp"
#include "host/report/page.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/certainty.hpp"
#include "host/robot/path/checks/program_check.hpp"
#include "host/robot/path/force_learning.hpp"
#include "host/robot/path/path_file.hpp"
#include "host/robot/path/tip_bound.hpp"

namespace biteline::results {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double k_rad_per_deg = std::numbers::pi / 180;

ordered_json as_json(const path::Check& check) {
  ordered_json out{{"name", check.name},
                   {"passed", check.passed},
                   {"value", check.value},
                   {"limit", check.limit},
                   {"unit", check.unit}};
  if (check.arc_mm >= 0) out["at_mm"] = check.arc_mm;
  if (!check.detail.empty()) out["detail"] = check.detail;
  return out;
}

ordered_json as_json(const path::Remedy& remedy) {
  ordered_json out = ordered_json::object();
  if (remedy.move_shoe_base)
    out["move_shoe_mm"] = {remedy.move_shoe_base->x(), remedy.move_shoe_base->y(),
                           remedy.move_shoe_base->z()};
  if (remedy.tilt_rad) out["tilt_deg"] = *remedy.tilt_rad / k_rad_per_deg;
  return out;
}

path::Certainty certainty(const path::PlanRequest& request, const path::PlanOutcome& outcome) {
  return path::certainty_of(outcome.path->path(), request.process.gate.tolerance_mm);
}

ordered_json number_or_null(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

/// Along the path: how certain it is, and where not certain enough to be sent.
ordered_json as_json(const path::Certainty& certainty, const path::GateLimits& limits) {
  ordered_json out{{"u95_max_mm", number_or_null(certainty.u95_mm)},
                   {"at_mm", certainty.at_mm},
                   {"tolerance_mm", number_or_null(limits.tolerance_mm)},
                   {"places", ordered_json::array()}};
  for (const path::UncertainPlace& place : certainty.places)
    out["places"].push_back(
        {{"from_mm", place.from_mm}, {"to_mm", place.to_mm}, {"u95_mm", number_or_null(place.u95_mm)}});
  return out;
}

/// Of the tool's true tip off the true line: what is known of it before it is sent.
ordered_json as_json(const path::TipParts& parts, const kinematics::ArmModel& arm,
                     const std::optional<double>& tolerance_mm) {
  ordered_json out{{"bound_mm", number_or_null(path::tip_bound_mm(parts))},
                   {"give_mm", parts.give_mm},
                   {"natural_hz", arm.give.natural_hz.minCoeff()},
                   {"natural_hz_measured", arm.give.measured},
                   {"tip_u95_mm", parts.tip_u95_mm},
                   {"tolerance_mm", number_or_null(tolerance_mm)}};
  if (tolerance_mm) out["risk_beyond"] = number_or_null(path::risk_beyond(parts, *tolerance_mm));
  return out;
}

ordered_json as_json(const path::Force& force, const std::optional<path::ForceLearned>& taught) {
  ordered_json out{{"set_n", force.set_newton}};
  if (!taught) return out;
  const path::ForceDrift drift = path::drift_of(*taught);
  out["learned"] = {{"shoes", taught->shoes},
                    {"air_runs", taught->air_runs},
                    {"sensor_drift_n", drift.error_newton},
                    {"ahead_n", drift.ahead_newton}};
  return out;
}

void fill_report(report::Report& report, const path::PlanRequest& request, const path::PlanOutcome& outcome) {
  ordered_json& fields = report.fields;
  fields["robot"] = request.arm.name;
  fields["calibrated"] = request.arm.calibrated;
  fields["process"] = request.process.name;
  fields["covered_width_mm"] = path::covered_width_mm(request.process);
  if (request.process.force && !request.tool_off)
    fields["force"] = as_json(*request.process.force, request.process.force_learned);
  fields["line_length_mm"] = cloud::length_mm(request.line);
  fields["seam_at_mm"] = outcome.tool_path.seam_arc_mm;
  fields["checks"] = ordered_json::array();
  for (const path::Check& check : outcome.checks) fields["checks"].push_back(as_json(check));
  if (outcome.path) {
    fields["points"] = outcome.path->path().waypoints.size();
    fields["stretches"] = ordered_json::array();
    for (const path::PathRun& run : path::runs_of(outcome.path->path(), path::Segment::Line)) {
      fields["stretches"].push_back({{"from_mm", outcome.path->path().waypoints[run.first].arc_mm},
                                     {"to_mm", outcome.path->path().waypoints[run.last].arc_mm}});
    }
    fields["duration_s"] = outcome.path->duration_s();
    const path::Certainty certain = certainty(request, outcome);
    fields["uncertainty"] = as_json(certain, request.process.gate);
    fields["tip"] = as_json(path::parts_of(outcome.path->path(), certain.u95_mm), request.arm,
                            request.process.gate.tip_tolerance_mm);
    return;
  }
  report.refuse(*outcome.refusal);
  if (outcome.blockage.what != path::Obstacle::None) {
    fields["blocked_at_mm"] = outcome.blockage.arc_mm;
    fields["blocked_by"] = outcome.blockage.detail;
    fields["what_would_help"] = as_json(outcome.remedy);
  }
}

void add_uncertain_places(report::Page& page, const path::PlanRequest& request,
                          const path::PlanOutcome& outcome) {
  if (!outcome.path) return;
  const path::Certainty certain = certainty(request, outcome);
  if (certain.places.empty()) return;
  page.heading("Too uncertain to be sent");
  std::vector<std::vector<std::string>> rows;
  for (const path::UncertainPlace& place : certain.places)
    rows.push_back({report::value_text(place.from_mm, "mm"), report::value_text(place.to_mm, "mm"),
                    place.u95_mm ? report::value_text(*place.u95_mm, "mm") : "not known"});
  page.table({"along the path from", "to", "U95"}, rows);
}

/// What write_coverage() has found.
void add_coverage(report::Page& page, const ordered_json& fields) {
  if (!fields.contains("coverage")) return;
  const ordered_json& coverage = fields["coverage"];
  const auto mm = [&](const char* key) { return report::value_text(coverage[key].get<double>(), "mm"); };
  page.heading("What the tool covers");
  page.table({"width on the surface", "", "along the path at"},
             {{"least", mm("least_width_mm"), mm("least_at_mm")},
              {"median", mm("median_width_mm"), ""},
              {"most", mm("most_width_mm"), mm("most_at_mm")}});
  page.picture("coverage.png", "once (green), again (red)");
}

/// index.html: the verdict, the viewer, every check.
Result<void> write_page(const fs::path& folder, const path::PlanRequest& request,
                        const path::PlanOutcome& outcome, const report::Report& report) {
  using report::Page;
  const std::string warning = uncertainty_warning(request, outcome);
  const std::string summary = outcome.path ? request.arm.name + " follows the line: every check passed" +
                                                 (warning.empty() ? "" : "; " + warning)
                                           : "refused: " + outcome.reason();
  cloud::PointCloud cloud;
  cloud.points = request.cloud;
  ViewData view{.title = "Path of " + request.process.name,
                .summary = summary,
                .found = outcome.path.has_value(),
                .report = report.fields,
                .cloud = &cloud,
                .line = &request.line,
                .T_base_shoe = std::nullopt,
                .path_mm = {}};
  if (outcome.path) {
    for (const path::Waypoint& waypoint : outcome.path->path().waypoints)
      view.path_mm.emplace_back(request.T_line_base * waypoint.T_base_tcp.translation());
  }
  if (outcome.refusal) add_refusal(view.report, report::told(*outcome.refusal));
  BITELINE_TRY(write_view(folder, view));

  Page page{"Path of " + request.process.name, summary,
            !outcome.path     ? Page::Mood::Refused
            : warning.empty() ? Page::Mood::Good
                              : Page::Mood::Look};
  if (outcome.refusal) add_next_step(page, report::told(*outcome.refusal));
  add_viewer(page, folder);
  add_uncertain_places(page, request, outcome);
  add_coverage(page, report.fields);
  page.heading("Checks");
  std::vector<std::vector<std::string>> rows;
  for (const path::Check& check : outcome.checks) {
    rows.push_back({check.name, check.passed ? "passed" : "NOT passed",
                    report::value_text(check.value, check.unit), report::value_text(check.limit, check.unit),
                    check.arc_mm >= 0 ? report::value_text(check.arc_mm, "mm") : "", check.detail});
  }
  page.table({"check", "verdict", "value", "limit", "along the line at", "what"}, rows);
  page.heading("Figures");
  page.figures(named_figures(report.fields));
  return page.write(folder / "index.html");
}

/// A name that cannot be removed is no name of a plan's file, or the next write says why.
void remove_plan(const fs::path& folder) {
  for (const char* name : {"path.script", "path.csv", "tracking.html", "report.json", "index.html",
                           "view_data.js", "files.js", "coverage.ply", "coverage.png"}) {
    std::error_code ignored;  // nothing there is what is wanted
    fs::remove(folder / name, ignored);
  }
}

}  // namespace

std::string uncertainty_warning(const path::PlanRequest& request, const path::PlanOutcome& outcome) {
  if (!outcome.path) return {};
  const path::Certainty certain = certainty(request, outcome);
  if (certain.places.empty()) return {};
  const double tolerance_mm = request.process.gate.tolerance_mm.value_or(0);
  if (!certain.u95_mm)
    return FixedText<120>::format("not to be sent as it is: its uncertainty is not known (tolerance %.2f mm)",
                                  tolerance_mm)
        .c_str();
  return FixedText<160>::format(
             "not to be sent as it is: U95 up to %.2f mm (tolerance %.2f mm), worst at %.0f mm of the path",
             *certain.u95_mm, tolerance_mm, certain.at_mm)
      .c_str();
}

Result<void> prepare_plan_folder(const fs::path& folder) {
  BITELINE_TRY(report::prepare_folder(folder));
  remove_plan(folder);
  return {};
}

Result<void> write_tracking(const fs::path& folder, const path::PlanRequest& request,
                            const path::PlanOutcome& outcome, const std::vector<path::TrackSample>& track) {
  std::vector<Vec3> shoe = outcome.surroundings.shoe_points;
  if (!request.cloud.empty()) {
    shoe.clear();
    const SE3 T_base_line = request.T_line_base.inverse();
    const std::size_t step = 1 + request.cloud.size() / results::k_most_points;
    for (std::size_t i = 0; i < request.cloud.size(); i += step)
      shoe.push_back(T_base_line * request.cloud[i].cast<double>());
  }
  return results::write_tracking_page(folder / "tracking.html",
                                      {.path = outcome.path->path(),
                                       .arm = request.arm,
                                       .tool = request.process.tool,
                                       .shoe_points_base = std::move(shoe),
                                       .shoe_is_guessed = request.cloud.empty(),
                                       .table_z_mm = outcome.surroundings.table_z_mm,
                                       .track = track});
}

Result<ExitStatus> write_plan_result(const fs::path& folder, const path::PlanRequest& request,
                                     const path::PlanOutcome& outcome, report::Report& report) {
  fill_report(report, request, outcome);
  const auto write_all = [&]() -> Result<void> {
    if (outcome.path) {
      BITELINE_TRY(
          report.timed("write", [&] { return path::write_path(folder / "path.csv", *outcome.path); }));
      BITELINE_TRY(report.timed_aside("page", [&] { return write_tracking(folder, request, outcome, {}); }));
    }
    BITELINE_TRY(report.timed_aside("page", [&] { return write_page(folder, request, outcome, report); }));
    BITELINE_TRY(report.write(folder));
    if (!outcome.path) return {};
    // Last but for its mention: a script stands only where everything that speaks for it does.
    BITELINE_TRY(report::write_file_atomically(folder / "path.script", robot::ur::urscript(*outcome.path)));
    return write_file_list(folder);
  };
  if (const Result<void> written = write_all(); !written) {
    remove_plan(folder);
    return tl::unexpected<Error>(written.error());
  }
  return outcome.path ? ExitStatus::Done : ExitStatus::Refused;
}

}  // namespace biteline::results
