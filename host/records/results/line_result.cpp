// SPDX-License-Identifier: MIT
#include "host/records/results/line_result.hpp"

#include <cstdio>
#include <utility>

#include "common/system/file.hpp"
#include "host/cloud/ply.hpp"
#include "host/records/results/line_uncertainty.hpp"
#include "host/records/results/pictures/stages.hpp"
#include "host/records/results/view/alternatives.hpp"
#include "host/records/results/view/page_parts.hpp"
#include "host/records/results/view/view_data.hpp"
#include "host/records/results/view/weak_stretches.hpp"
#include "host/report/json_text.hpp"
#include "host/report/page.hpp"

namespace biteline::results {
namespace {

nlohmann::ordered_json candidates_of(const bite_line::Extraction& extraction) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const bite_line::Candidate& candidate : extraction.candidates) {
    list.push_back({{"confidence", candidate.confidence},
                    {"mean_height_mm", candidate.mean_height_mm},
                    {"length_mm", candidate.length_mm},
                    {"closure_mm", candidate.closure_mm},
                    {"crease_deg", candidate.crease_deg},
                    {"seen_share", candidate.seen_share}});
  }
  return list;
}

/// What each gate measured, beside its limit.
nlohmann::ordered_json gates_of(const bite_line::Extraction& extraction) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const bite_line::SeenGate& gate : extraction.gates) {
    list.push_back({{"reason_code", report::refusal_row(gate.code).name},
                    {"measure", gate.measure},
                    {"value", gate.value},
                    {gate.at_most ? "at_most" : "at_least", gate.limit},
                    {"sure", gate.sure}});
  }
  return list;
}

/// The bit of `lacks` that the refusal speaks of; 0: of no single place.
int lack_told(const bite_line::Extraction& extraction) {
  return extraction.refusal ? bite_line::lack_of(extraction.refusal->code) : 0;
}

/// index.html: the verdict, the viewer, what to look at, the figures, the time of each stage, the pictures.
Result<void> write_page(const std::filesystem::path& folder, const bite_line::Extraction& extraction,
                        const std::vector<WeakStretch>& weak, const report::Report& report) {
  using report::Page;
  const bool refused = extraction.verdict() == bite_line::Verdict::Refused;
  const Page::Mood mood = refused                            ? Page::Mood::Refused
                          : extraction.found && weak.empty() ? Page::Mood::Good
                                                             : Page::Mood::Look;
  Page page{"Bite line", summary(extraction), mood};
  if (const auto told = extraction.told()) add_next_step(page, *told);
  add_weak_stretches(page, weak);
  add_viewer(page, folder);
  page.heading("Figures");
  page.figures(named_figures(report.fields));
  add_u95(page, report.fields);
  if (extraction.candidates.size() > 1) {
    page.heading("Candidates");
    std::vector<std::vector<std::string>> rows;
    for (const bite_line::Candidate& candidate : extraction.candidates) {
      rows.push_back(
          {report::value_text(candidate.confidence, ""), report::value_text(candidate.mean_height_mm, "mm"),
           report::value_text(candidate.length_mm, "mm"), report::value_text(candidate.crease_deg, "degrees"),
           report::value_text(100 * candidate.seen_share, "%")});
    }
    page.table({"confidence", "mean height", "length", "crease", "seen"}, rows);
  }
  page.heading("Time");
  std::vector<std::pair<std::string, double>> stages;
  for (const report::StageTime& stage : extraction.stages) stages.emplace_back(stage.name, stage.seconds);
  page.durations(stages);
  page.heading("Stages");
  for (const auto& [file, caption] : results::pictures(folder / "stages"))
    page.picture("stages/" + file, caption);
  return page.write(folder / "index.html");
}

}  // namespace

Result<void> prepare_result_folder(const std::filesystem::path& folder) {
  BITELINE_TRY(report::prepare_folder(folder));
  for (const char* name : {"line.csv", "report.json"}) {
    std::error_code error;
    std::filesystem::remove(folder / name, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", (folder / name).c_str());
  }
  return {};
}

void fill_seam(const std::optional<bite_line::SeamStep>& seam, report::Report& report) {
  if (!seam) return;
  report.fields["seam_step_mm"] = seam->out_mm;
  report.fields["moved_mm"] = seam->moved_mm;
}

Result<ExitStatus> write_line_files(const std::filesystem::path& folder, const cloud::PointCloud& cloud,
                                    const bite_line::Extraction& extraction, report::Report& report) {
  using enum bite_line::Verdict;
  const bite_line::Verdict verdict = extraction.verdict();
  report.fields["points"] = cloud.size();
  fill_seam(extraction.seam, report);
  if (verdict == Review) report.review(*extraction.told());
  if (verdict != Refused) {
    report.fields["length_mm"] = extraction.length_mm;
    report.fields["closure_mm"] = extraction.closure_mm;
    report.fields["confidence"] = extraction.confidence;
    report.fields["bridged_mm"] = extraction.bridged_mm;
    report.fields["line_points"] = extraction.line.points.size();
  } else {
    report.refuse(*extraction.told());
    if (extraction.scan_cause && extraction.refusal) {
      const report::ToldRefusal seen = report::told(*extraction.refusal);
      report.fields["of_what_was_seen"] = {{"reason_code", seen.reason_code}, {"reason", seen.reason}};
    }
    report.fields["confidence"] = extraction.confidence;
  }
  report.fields["candidates"] = candidates_of(extraction);
  if (!extraction.gates.empty()) report.fields["gates"] = gates_of(extraction);
  const std::vector<WeakStretch> weak = weak_stretches(extraction.line, extraction.T_base_shoe);
  if (verdict != Refused) {
    report.fields["weak_stretches"] = verdict == Review
                                          ? as_open(weak, extraction.line, extraction.candidates)
                                          : as_json(weak, cloud::length_mm(extraction.line));
    report.fields["u95"] = u95_json(
        extraction.line, parts_of_found_line({.head = extraction.head_in_u95, .arm = extraction.arm}));
  }
  for (const report::StageTime& stage : extraction.stages)
    report.fields["extraction_s"][stage.name] = stage.seconds;

  BITELINE_TRY(report.timed("write", [&]() -> Result<void> {
    BITELINE_TRY(cloud::write_cloud(folder / "cloud.ply", cloud));
    if (verdict == Refused) return {};
    return cloud::write_line(folder / "line.csv", extraction.line);
  }));
  report.stop_clock();
  BITELINE_TRY(report.write(folder));
  return report.status();
}

Result<void> write_report_again(const std::filesystem::path& folder, report::Report& report) {
  using nlohmann::ordered_json;
  const Result<std::string> before = read_regular_file(folder / "report.json", k_most_settings_bytes);
  ordered_json all = before ? ordered_json::parse(*before, nullptr, false) : ordered_json{};
  if (!all.is_object()) return report.write(folder);
  all.update(ordered_json::parse(report.text()));
  return report::write_file_atomically(folder / "report.json", report::to_text(all) + "\n");
}

Result<void> write_line_pages(const std::filesystem::path& folder, const cloud::PointCloud& cloud,
                              const bite_line::Extraction& extraction, const StageSource& stages,
                              report::Report& report) {
  const std::vector<WeakStretch> weak = weak_stretches(extraction.line, extraction.T_base_shoe);
  BITELINE_TRY(report.timed_aside("pictures", [&]() -> Result<void> {
    const bite_line::LineStages shown = stages();
    report.fields["feature_points"] = shown.feature_points.size();
    if (!shown.plain_svd_features.empty())
      report.fields["feature_points_plain_svd"] = shown.plain_svd_features.size();
    BITELINE_TRY(results::write_stages(folder / "stages", shown, extraction));
    ViewData view{.title = "Bite line",
                  .summary = summary(extraction),
                  .found = extraction.verdict() != bite_line::Verdict::Refused,
                  .report = report.fields,
                  .cloud = &cloud,
                  .line = &extraction.line,
                  .candidates = {},
                  .T_base_shoe = extraction.T_base_shoe,
                  .path_mm = {}};
    if (!view.found) {
      view.candidates = extraction.candidates;
      view.report["lack"] = lack_told(extraction);
    }
    if (const auto told = extraction.told()) add_refusal(view.report, *told);
    BITELINE_TRY(write_view(folder, view));
    return write_page(folder, extraction, weak, report);
  }));
  return write_report_again(folder, report);
}

Result<ExitStatus> write_line_result(const std::filesystem::path& folder, const cloud::PointCloud& cloud,
                                     const bite_line::Extraction& extraction, const StageSource& stages,
                                     report::Report& report) {
  BITELINE_ASSIGN(const ExitStatus status, write_line_files(folder, cloud, extraction, report));
  BITELINE_TRY(write_line_pages(folder, cloud, extraction, stages, report));
  return status;
}

std::string summary(const bite_line::Extraction& extraction) {
  char text[512];
  if (extraction.found) {
    std::snprintf(text, sizeof text, "bite line found: %.1f mm long, %zu points, confidence %.2f",
                  extraction.length_mm, extraction.line.points.size(), extraction.confidence);
  } else if (extraction.verdict() == bite_line::Verdict::Review) {
    double open_mm = 0;
    for (const WeakStretch& stretch : weak_stretches(extraction.line, extraction.T_base_shoe))
      open_mm += stretch.length_mm;
    std::snprintf(text, sizeof text, "review: a line of %.1f mm, of which a person must settle %.1f mm: %s",
                  extraction.length_mm, open_mm, extraction.reason().c_str());
  } else {
    std::snprintf(text, sizeof text, "refused: %s", extraction.reason().c_str());
  }
  return text;
}

}  // namespace biteline::results
