// SPDX-License-Identifier: MIT
#include "host/results/line_result.hpp"

#include <cstdio>
#include <utility>

#include "host/cloud/ply.hpp"
#include "host/report/json_text.hpp"
#include "host/report/page.hpp"
#include "host/results/pictures/stages.hpp"

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

/// index.html: the verdict, the figures, the time of each stage, the pictures.
Result<void> write_page(const std::filesystem::path& folder, const bite_line::Extraction& extraction,
                        const report::Report& report) {
  using report::Page;
  Page page{"Bite line", summary(extraction), extraction.found ? Page::Mood::Good : Page::Mood::Refused};
  std::vector<std::pair<std::string, std::string>> figures;
  for (const auto& [name, value] : report.fields.items()) {
    if (value.is_number_float()) figures.emplace_back(name, report::value_text(value.get<double>(), ""));
    if (value.is_number_integer() || value.is_string())
      figures.emplace_back(name, value.is_string() ? value.get<std::string>() : report::to_text(value, -1));
  }
  page.heading("Figures");
  page.figures(figures);
  if (extraction.candidates.size() > 1) {
    page.heading("Candidates");
    std::vector<std::pair<std::string, std::string>> rows;
    for (const bite_line::Candidate& candidate : extraction.candidates) {
      char text[160];
      std::snprintf(text, sizeof text, "height %.1f mm, length %.1f mm, crease %.0f degrees, seen %.0f %%",
                    candidate.mean_height_mm, candidate.length_mm, candidate.crease_deg,
                    100 * candidate.seen_share);
      rows.emplace_back(report::value_text(candidate.confidence, ""), text);
    }
    page.figures(rows);
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

Result<ExitStatus> write_line_result(const std::filesystem::path& folder, const cloud::PointCloud& cloud,
                                     const bite_line::Extraction& extraction, const StageSource& stages,
                                     report::Report& report) {
  report.fields["points"] = cloud.size();
  if (extraction.found) {
    report.fields["length_mm"] = extraction.length_mm;
    report.fields["closure_mm"] = extraction.closure_mm;
    report.fields["confidence"] = extraction.confidence;
    report.fields["bridged_mm"] = extraction.bridged_mm;
    report.fields["line_points"] = extraction.line.points.size();
  } else {
    report.refuse(*extraction.refusal);
    report.fields["confidence"] = extraction.confidence;
  }
  report.fields["candidates"] = candidates_of(extraction);
  for (const report::StageTime& stage : extraction.stages)
    report.fields["extraction_s"][stage.name] = stage.seconds;

  BITELINE_TRY(report.timed("write", [&]() -> Result<void> {
    BITELINE_TRY(cloud::write_cloud(folder / "cloud.ply", cloud));
    if (!extraction.found) return {};
    return cloud::write_line(folder / "line.csv", extraction.line);
  }));
  report.stop_clock();
  BITELINE_TRY(report.timed_aside("pictures", [&]() -> Result<void> {
    const bite_line::LineStages shown = stages();
    report.fields["feature_points"] = shown.feature_points.size();
    if (!shown.plain_svd_features.empty())
      report.fields["feature_points_plain_svd"] = shown.plain_svd_features.size();
    BITELINE_TRY(results::write_stages(folder / "stages", shown, extraction));
    return write_page(folder, extraction, report);
  }));
  BITELINE_TRY(report.write(folder));
  return extraction.found ? ExitStatus::Done : ExitStatus::Refused;
}

std::string summary(const bite_line::Extraction& extraction) {
  char text[512];
  if (extraction.found) {
    std::snprintf(text, sizeof text, "bite line found: %.1f mm long, %zu points, confidence %.2f",
                  extraction.length_mm, extraction.line.points.size(), extraction.confidence);
  } else {
    std::snprintf(text, sizeof text, "refused: %s", extraction.reason().c_str());
  }
  return text;
}

}  // namespace biteline::results
