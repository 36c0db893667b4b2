// SPDX-License-Identifier: MIT
#include "host/records/results/transfer_result.hpp"

#include "common/core/fixed_text.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/records/results/line_result.hpp"
#include "host/records/results/line_uncertainty.hpp"
#include "host/records/results/pictures/transfer_stages.hpp"
#include "host/records/results/view/page_parts.hpp"
#include "host/records/results/view/view_data.hpp"
#include "host/records/results/view/weak_stretches.hpp"
#include "host/report/json_text.hpp"
#include "host/report/page.hpp"

namespace biteline::results {
namespace {

nlohmann::ordered_json rows_of(const Eigen::Matrix4d& T) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int i = 0; i < 4; ++i) rows.push_back({T(i, 0), T(i, 1), T(i, 2), T(i, 3)});
  return rows;
}

nlohmann::ordered_json json_of(const transfer::Alignment& alignment) {
  const transfer::Grade& grade = alignment.placement.grade;
  nlohmann::ordered_json information = nlohmann::ordered_json::array();
  for (Eigen::Index row = 0; row < alignment.information.rows(); ++row) {
    nlohmann::ordered_json values = nlohmann::ordered_json::array();
    for (Eigen::Index column = 0; column < alignment.information.cols(); ++column)
      values.push_back(alignment.information(row, column));
    information.push_back(values);
  }
  return {
      {"converged", alignment.converged},
      {"iterations", alignment.iterations},
      {"T_upper_sample", rows_of(alignment.T_upper_sample.matrix())},
      {"T_upper_shoe", rows_of(alignment.placement.T_target_source.matrix())},
      {"mirrored", alignment.mirrored},
      {"grade",
       {{"length", grade.length},
        {"width", grade.width},
        {"section_along", grade.section_along},
        {"section_across", grade.section_across},
        {"height", grade.height},
        {"offset_mm", grade.offset_mm}}},
      {"overlap_share", alignment.overlap_ratio},
      {"upper_overlap_share", alignment.upper_overlap_ratio},
      {"residual_rms_mm", alignment.residual_rms_mm},
      {"shape_rms_mm", alignment.shape_rms_mm},
      {"rim_used", alignment.rim_used},
      {"same_edge_probability", alignment.same_edge_ratio},
      {"rim_mm", alignment.rim_mm},
      {"line_sigma_mm", alignment.line_sigma_mm},
      {"weakest_direction", {{"words", alignment.weakest.words}, {"sigma_mm", alignment.weakest.sigma_mm}}},
      {"runner_up_ratio", alignment.runner_up_ratio},
      {"information", information}};
}

void fill(const transfer::Transfer& transfer, report::Report& report) {
  if (!transfer.stages.empty()) report.fields["alignment"] = json_of(transfer.alignment);
  report.fields["confidence"] = transfer.confidence;
  report.fields["bound_mm"] = transfer.bound_mm;
  fill_seam(transfer.seam, report);
  if (!transfer.scan_cause && !transfer.alignment.next_step.empty())
    report.fields["next_step"] = transfer.alignment.next_step;
  report.fields["surface"] = transfer.from_mesh ? "mesh" : "points";
  for (const report::StageTime& stage : transfer.stages)
    report.fields["transfer_s"][stage.name] = stage.seconds;
  if (const auto told = transfer.told()) return report.refuse(*told);
  const transfer::CarriedLine& carried = transfer.carried;
  const cloud::ClosedLine& line = carried.line;
  report.fields["length_mm"] = cloud::length_mm(line);
  report.fields["closure_mm"] = (line.points.front().position - line.points.back().position).norm();
  report.fields["line_points"] = line.points.size();
  report.fields["rays"] = carried.rays;
  report.fields["hits"] = carried.hits;
  report.fields["bridged_mm"] = carried.bridged_mm;
  report.fields["longest_gap_mm"] = carried.longest_gap_mm;
  report.fields["mean_ray_mm"] = carried.mean_distance_mm;
  report.fields["candidates"] = nlohmann::ordered_json::array(
      {{{"confidence", transfer.confidence}, {"length_mm", cloud::length_mm(line)}}});
  std::vector<std::size_t> bridged;
  for (std::size_t i = 0; i < carried.bridged.size(); ++i) {
    if (carried.bridged[i]) bridged.push_back(i);
  }
  report.fields["bridged_points"] = bridged;
}

/// index.html: the verdict, the viewer, what to look at, the figures, the time of each stage, the pictures.
Result<void> write_page(const std::filesystem::path& folder, const transfer::Transfer& transfer,
                        const std::vector<WeakStretch>& weak, const report::Report& report) {
  using report::Page;
  using report::value_text;
  const Page::Mood mood = !transfer.found ? Page::Mood::Refused
                          : weak.empty()  ? Page::Mood::Good
                                          : Page::Mood::Look;
  Page page{"Bite line from a sample", summary(transfer), mood};
  if (const auto told = transfer.told()) add_next_step(page, *told);
  add_weak_stretches(page, weak);
  add_viewer(page, folder);
  if (!transfer.stages.empty()) {
    const transfer::Alignment& alignment = transfer.alignment;
    page.heading("How good");
    std::vector<std::pair<std::string, std::string>> figures{
        {"19 of 20 points of the line are nearer to the bite line than", value_text(transfer.bound_mm, "mm")},
        {"confidence, mean over the line", value_text(transfer.confidence, "")},
        {"difference of the two shapes, RMS", value_text(alignment.shape_rms_mm, "mm")},
        {"share of the sample's surface above its line that the scan shows",
         value_text(alignment.overlap_ratio, "")},
        {"share of the scan above the line that lies on the sample",
         value_text(alignment.upper_overlap_ratio, "")},
        {"least certain direction: " + alignment.weakest.words,
         value_text(alignment.weakest.sigma_mm, "mm")}};
    if (transfer.found) {
      figures.emplace_back("rays that met the upper", std::to_string(transfer.carried.hits) + " of " +
                                                          std::to_string(transfer.carried.rays));
      figures.emplace_back("bridged over gaps", value_text(transfer.carried.bridged_mm, "mm"));
    }
    page.figures(figures);
    page.heading("Time");
    std::vector<std::pair<std::string, double>> stages;
    for (const report::StageTime& stage : transfer.stages) stages.emplace_back(stage.name, stage.seconds);
    page.durations(stages);
    page.heading("Stages");
    for (const auto& [file, caption] : results::transfer_pictures(folder / "stages"))
      page.picture("stages/" + file, caption);
  }
  page.heading("All figures");
  page.figures(named_figures(report.fields));
  add_u95(page, report.fields);
  return page.write(folder / "index.html");
}

}  // namespace

Result<ExitStatus> write_transfer_files(const std::filesystem::path& folder, const cloud::PointCloud& upper,
                                        const transfer::Transfer& transfer, report::Report& report) {
  report.fields["points"] = upper.size();
  fill(transfer, report);
  const SE3& T_base_shoe = transfer.alignment.placement.T_target_source;
  const std::vector<WeakStretch> weak = weak_stretches(transfer.carried.line, T_base_shoe);
  if (transfer.found) {
    report.fields["weak_stretches"] = as_json(weak, cloud::length_mm(transfer.carried.line));
    report.fields["u95"] = u95_json(
        transfer.carried.line,
        parts_of_carried_line({.head = transfer.head_u95, .arm = transfer.arm}, transfer.sample_u95));
  }
  if (transfer.found) {
    BITELINE_TRY(
        report.timed("write", [&] { return cloud::write_line(folder / "line.csv", transfer.carried.line); }));
  }
  report.stop_clock();
  BITELINE_TRY(report.write(folder));
  return transfer.found ? ExitStatus::Done : ExitStatus::Refused;
}

Result<void> write_transfer_pages(const std::filesystem::path& folder, const cloud::PointCloud& upper,
                                  const transfer::Transfer& transfer, report::Report& report) {
  const SE3& T_base_shoe = transfer.alignment.placement.T_target_source;
  const std::vector<WeakStretch> weak = weak_stretches(transfer.carried.line, T_base_shoe);
  BITELINE_TRY(report.timed_aside("pictures", [&]() -> Result<void> {
    if (!upper.points.empty())
      BITELINE_TRY(results::write_transfer_stages(folder / "stages", upper, transfer));
    ViewData view{.title = "Bite line from a sample",
                  .summary = summary(transfer),
                  .found = transfer.found,
                  .report = report.fields,
                  .cloud = &upper,
                  .line = &transfer.carried.line,
                  .T_base_shoe = T_base_shoe,
                  .path_mm = {}};
    if (const auto told = transfer.told()) add_refusal(view.report, *told);
    BITELINE_TRY(write_view(folder, view));
    return write_page(folder, transfer, weak, report);
  }));
  return write_report_again(folder, report);
}

Result<ExitStatus> write_transfer_result(const std::filesystem::path& folder, const cloud::PointCloud& upper,
                                         const transfer::Transfer& transfer, report::Report& report) {
  BITELINE_ASSIGN(const ExitStatus status, write_transfer_files(folder, upper, transfer, report));
  BITELINE_TRY(write_transfer_pages(folder, upper, transfer, report));
  return status;
}

std::string summary(const transfer::Transfer& transfer) {
  if (!transfer.found) return "refused: " + transfer.reason();
  const cloud::ClosedLine& line = transfer.carried.line;
  return FixedText<240>::format(
             "line carried over: %.1f mm long, %zu points, surfaces alike to %.2f mm RMS over %.0f %%, line "
             "within %.2f mm",
             cloud::length_mm(line), line.points.size(), transfer.alignment.shape_rms_mm,
             100 * transfer.alignment.overlap_ratio, transfer.bound_mm)
      .c_str();
}

}  // namespace biteline::results
