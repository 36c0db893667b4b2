// SPDX-License-Identifier: MIT
#include "host/records/results/refused_result.hpp"

#include "host/cloud/ply.hpp"
#include "host/records/results/view/page_parts.hpp"

namespace biteline::results {

Result<void> write_refused_result(const std::filesystem::path& folder, const cloud::PointCloud& cloud,
                                  const report::ToldRefusal& refusal, report::Report& report) {
  report.refuse(refusal);
  report.fields["points"] = cloud.size();
  report.fields["confidence"] = 0.0;
  BITELINE_TRY(report.timed("write", [&] { return cloud::write_cloud(folder / "cloud.ply", cloud); }));
  report.stop_clock();
  BITELINE_TRY(report.write(folder));
  report::Page page{"Bite line", "refused: " + refusal.reason, report::Page::Mood::Refused};
  add_next_step(page, refusal);
  page.heading("Figures");
  page.figures(named_figures(report.fields));
  return page.write(folder / "index.html");
}

}  // namespace biteline::results
