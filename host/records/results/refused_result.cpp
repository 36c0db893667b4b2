// SPDX-License-Identifier: MIT
#include "host/records/results/refused_result.hpp"

#include "host/cloud/ply.hpp"
#include "host/records/results/view/page_parts.hpp"
#include "host/records/results/view/view_data.hpp"

namespace biteline::results {

Result<void> write_refused_view(const std::filesystem::path& folder, const cloud::PointCloud& cloud,
                                const report::ToldRefusal& refusal, const report::Report& report) {
  ViewData view{.title = "Bite line",
                .summary = "refused: " + refusal.reason,
                .found = false,
                .report = report.fields,
                .cloud = &cloud,
                .line = nullptr,
                .T_base_shoe = {},
                .path_mm = {}};
  add_refusal(view.report, refusal);
  return write_view(folder, view);
}

Result<void> write_refused_result(const std::filesystem::path& folder, const cloud::PointCloud& cloud,
                                  const report::ToldRefusal& refusal, report::Report& report) {
  report.refuse(refusal);
  report.fields["points"] = cloud.size();
  report.fields["confidence"] = 0.0;
  BITELINE_TRY(report.timed("write", [&] { return cloud::write_cloud(folder / "cloud.ply", cloud); }));
  report.stop_clock();
  BITELINE_TRY(report.write(folder));
  BITELINE_TRY(write_refused_view(folder, cloud, refusal, report));
  report::Page page{"Bite line", "refused: " + refusal.reason, report::Page::Mood::Refused};
  add_next_step(page, refusal);
  add_viewer(page, folder);
  page.heading("Figures");
  page.figures(named_figures(report.fields));
  return page.write(folder / "index.html");
}

}  // namespace biteline::results
