// SPDX-License-Identifier: MIT
#include "host/records/results/view/page_parts.hpp"

#include <array>
#include <cstdio>
#include <string_view>

#include "host/report/json_text.hpp"

namespace biteline::results {
namespace {

/// A key of report.json as a person reads it.
struct FigureName {
  std::string_view key;
  const char* words;
  const char* unit;
};
constexpr std::array k_names{
    FigureName{"points", "points in the cloud", ""},
    FigureName{"length_mm", "length of the line", "mm"},
    FigureName{"closure_mm", "gap where the line's ends meet", "mm"},
    FigureName{"seam_step_mm", "how far out the scan's end lies from its begin", "mm"},
    FigureName{"moved_mm", "how far the shoe lies elsewhere at the scan's end, at most", "mm"},
    FigureName{"confidence", "confidence in the line as a whole (0 to 1)", ""},
    FigureName{"bridged_mm", "bridged: no crease seen there, joined from both sides", "mm"},
    FigureName{"line_points", "points on the line", ""},
    FigureName{"feature_points", "points found in the crease", ""},
    FigureName{"feature_points_plain_svd", "the same by plain SVD, for comparison", ""},
    FigureName{"bound_mm", "19 of 20 points of the line are nearer than", "mm"},
    FigureName{"rays", "rays sent from the sample's line", ""},
    FigureName{"hits", "rays that met the upper", ""},
    FigureName{"longest_gap_mm", "longest gap in the scan along the line", "mm"},
    FigureName{"mean_ray_mm", "mean way from the sample's line to this one", "mm"},
    FigureName{"surface", "the upper's surface is made of", ""},
    FigureName{"sample", "sample", ""},
    FigureName{"session", "recorded session", ""},
    FigureName{"method", "method", ""},
    FigureName{"duration_s", "time of the path", "s"},
    FigureName{"line_length_mm", "length of the line", "mm"},
    FigureName{"covered_width_mm", "width that the tool covers", "mm"},
    FigureName{"seam_at_mm", "the path begins along the line at", "mm"},
    FigureName{"robot", "robot", ""},
    FigureName{"process", "process", ""},
    FigureName{"blocked_at_mm", "blocked along the line at", "mm"},
    FigureName{"blocked_by", "blocked by", ""},
    FigureName{"next_step", "what would help", ""},
};

std::string value_of(const nlohmann::ordered_json& value, const char* unit) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return report::value_text(value.get<double>(), unit);
  const std::string text = report::to_text(value, -1);
  return *unit ? text + " " + unit : text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> named_figures(const nlohmann::ordered_json& fields) {
  std::vector<std::pair<std::string, std::string>> figures;
  for (const auto& [key, value] : fields.items()) {
    if (!value.is_number() && !value.is_string()) continue;
    const FigureName* name = nullptr;
    for (const FigureName& row : k_names) {
      if (row.key == key) name = &row;
    }
    figures.emplace_back(name ? name->words : key, value_of(value, name ? name->unit : ""));
  }
  return figures;
}

void add_next_step(report::Page& page, const report::ToldRefusal& refusal) {
  if (!refusal.next_step.empty()) page.paragraph("What to do: " + refusal.next_step + ".");
}

void add_refusal(nlohmann::ordered_json& fields, const report::ToldRefusal& refusal) {
  fields["reason_code"] = refusal.reason_code;
  fields["reason"] = refusal.reason;
  fields["next_step"] = refusal.next_step;
}

void add_weak_stretches(report::Page& page, const std::vector<WeakStretch>& stretches) {
  if (stretches.empty()) return;
  page.heading("Look at these stretches");
  page.paragraph(warning(stretches) + ".");
  std::vector<std::vector<std::string>> rows;
  for (const WeakStretch& stretch : stretches) {
    char error[80];
    std::snprintf(error, sizeof error, "%s%.2f mm", stretch.u95_is_guessed ? "about " : "", stretch.u95_mm);
    rows.push_back({stretch.place, report::value_text(stretch.from_mm, "mm"),
                    report::value_text(stretch.length_mm, "mm"), error,
                    report::value_text(stretch.least_confidence, "")});
  }
  page.table({"place", "along the line from", "length", "likely error below (95 %)", "least confidence"},
             rows);
}

}  // namespace biteline::results
