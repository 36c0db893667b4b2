// SPDX-License-Identifier: MIT
#include "host/records/results/line_uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace biteline::results {

namespace {

void add_scan(const U95OfScan& scan, U95Parts& parts) {
  for (const char* part : {"calibration", "poses", "clock"})
    (scan.head ? parts.holds : parts.lacks).emplace_back(part);
  const bool assumed = scan.arm && scan.arm->source == uncertainty::ArmSource::Assumed;
  (scan.arm ? parts.holds : parts.lacks).emplace_back(assumed ? "the arm's give, assumed" : "the arm's give");
}

}  // namespace

U95Parts parts_of_found_line(const U95OfScan& scan) {
  U95Parts parts{.holds = {"noise", "gaps", "profiles", "other layers"}, .lacks = {}, .arm = scan.arm};
  add_scan(scan, parts);
  return parts;
}

U95Parts parts_of_carried_line(const U95OfScan& scan, bool sample) {
  U95Parts parts{.holds = {"alignment", "difference of the lasts", "gaps"}, .lacks = {}, .arm = scan.arm};
  (sample ? parts.holds : parts.lacks).emplace_back("the sample's own line");
  add_scan(scan, parts);
  return parts;
}

double pooled_u95_mm(const cloud::ClosedLine& line) {
  constexpr int k_halvings = 30;
  double high = 0;
  for (const cloud::LinePoint& p : line.points) high = std::max(high, p.u95_mm.value_or(0));
  double low = 0;
  for (int i = 0; i < k_halvings; ++i) {
    const double middle = 0.5 * (low + high);
    double outside = 0;
    // Rayleigh: beyond r with 0.05^((r / u95)^2).
    for (const cloud::LinePoint& p : line.points)
      outside += std::pow(0.05, std::pow(middle / std::max(p.u95_mm.value_or(0), 1e-6), 2));
    (outside > 0.05 * static_cast<double>(line.points.size()) ? low : high) = middle;
  }
  return high;
}

nlohmann::ordered_json u95_json(const cloud::ClosedLine& line, const U95Parts& parts) {
  double most_mm = -1, arc_mm = 0, at_mm = 0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const cloud::LinePoint& p = line.points[i];
    if (!p.u95_mm) return nullptr;
    if (*p.u95_mm > most_mm) {
      most_mm = *p.u95_mm;
      at_mm = arc_mm;
    }
    arc_mm += (line.points[(i + 1) % line.points.size()].position - p.position).norm();
  }
  if (line.points.empty()) return nullptr;
  nlohmann::ordered_json json{{"pooled_mm", pooled_u95_mm(line)},
                              {"max_mm", most_mm},
                              {"max_at_mm", at_mm},
                              {"holds", parts.holds},
                              {"lacks", parts.lacks}};
  if (parts.arm) {
    json["arm_sigma_mm"] = parts.arm->sigma_mm;
    json["arm_from"] = uncertainty::to_string(parts.arm->source);
    if (parts.arm->give_mm_per_m_s2 > 0) json["arm_give_mm_per_m_s2"] = parts.arm->give_mm_per_m_s2;
    if (parts.arm->profiles > 0) json["arm_profiles"] = parts.arm->profiles;
  }
  return json;
}

namespace {

/// Of `arm_from`, and what to do about an assumption.
std::string arm_words(const std::string& from) {
  if (from == to_string(uncertainty::ArmSource::Assumed))
    return "nothing, so much is assumed: show the table or fixture all the way round";
  if (from == to_string(uncertainty::ArmSource::Stated)) return "uncertainty.yaml";
  return from == to_string(uncertainty::ArmSource::Table) ? "the table, in this scan" : "earlier scans";
}

}  // namespace

void add_u95(report::Page& page, const nlohmann::ordered_json& fields) {
  if (!fields.contains("u95") || !fields["u95"].is_object()) return;
  const nlohmann::ordered_json& u95 = fields["u95"];
  const auto mm = [&](const char* key) { return report::value_text(u95[key].get<double>(), "mm"); };
  const auto words = [&](const char* key) {
    std::string all;
    for (const auto& word : u95[key]) all += (all.empty() ? "" : ", ") + word.get<std::string>();
    return all.empty() ? std::string{"nothing"} : all;
  };
  std::vector<std::pair<std::string, std::string>> figures{
      {"95 % of the line's points are nearer to the bite line than", mm("pooled_mm")},
      {"largest U95 of a point", mm("max_mm")},
      {"there, along the line at", mm("max_at_mm")},
      {"it holds", words("holds")},
      {"it does not hold", words("lacks")}};
  if (u95.contains("arm_from"))
    figures.push_back({"the arm's give is known from", arm_words(u95["arm_from"].get<std::string>())});
  page.heading("Uncertainty (U95)");
  page.figures(figures);
}

}  // namespace biteline::results
