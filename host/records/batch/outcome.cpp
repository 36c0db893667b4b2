// SPDX-License-Identifier: MIT
#include "host/records/batch/outcome.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "host/bite_line/evaluation/line_error.hpp"
#include "host/records/batch/json_fields.hpp"

namespace biteline::batch {
namespace {

using nlohmann::ordered_json;

constexpr std::array k_verdicts{"ok",      "review",    "refused",       "unreadable", "failed",
                                "crashed", "timed_out", "out_of_memory", "changed"};

constexpr std::array k_figures{FigureRow{"length_mm", &Outcome::length_mm},
                               FigureRow{"confidence", &Outcome::confidence},
                               FigureRow{"u95_mm", &Outcome::u95_mm},
                               FigureRow{"u95_max_mm", &Outcome::u95_max_mm},
                               FigureRow{"bridged_mm", &Outcome::bridged_mm},
                               FigureRow{"error_mean_mm", &Outcome::error_mean_mm},
                               FigureRow{"error_p95_mm", &Outcome::error_p95_mm},
                               FigureRow{"error_max_mm", &Outcome::error_max_mm},
                               FigureRow{"complete", &Outcome::complete},
                               FigureRow{"u95_inside", &Outcome::u95_inside},
                               FigureRow{"wrong_mm", &Outcome::wrong_mm}};

/// Beyond this an unflagged point is off.
constexpr double k_off_mm = 1;

}  // namespace

std::span<const char* const> verdict_names() {
  return k_verdicts;
}

bool has_line(const std::string& verdict) {
  return verdict == "ok" || verdict == "review";
}

bool is_answer(const std::string& verdict) {
  return has_line(verdict) || verdict == "refused" || verdict == "unreadable";
}

std::span<const FigureRow> figure_table() {
  return k_figures;
}

ordered_json to_json(const Outcome& outcome) {
  ordered_json json{{"verdict", outcome.verdict}};
  if (!outcome.reason_code.empty()) json["reason_code"] = outcome.reason_code;
  if (!outcome.reason.empty()) json["reason"] = outcome.reason;
  for (const FigureRow& row : k_figures) {
    if (outcome.*row.member) json[row.name] = *(outcome.*row.member);
  }
  if (!outcome.line_hash.empty()) json["line_hash"] = outcome.line_hash;
  return json;
}

Result<Outcome> outcome_of(const ordered_json& json, const std::filesystem::path& file) {
  const JsonFields fields{json, file};
  Outcome outcome;
  BITELINE_ASSIGN(outcome.verdict, fields.text("verdict"));
  if (std::ranges::find(k_verdicts, std::string_view{outcome.verdict}) == k_verdicts.end())
    return fail(Errc::BadValue, "%.180s key verdict: '%.40s'", file.c_str(), outcome.verdict.c_str());
  outcome.reason_code = fields.text("reason_code").value_or("");
  outcome.reason = fields.text("reason").value_or("");
  outcome.line_hash = fields.text("line_hash").value_or("");
  for (const FigureRow& row : k_figures) {
    BITELINE_ASSIGN(outcome.*row.member, fields.number_if(row.name));
  }
  return outcome;
}

void judge_by_truth(Outcome& outcome, const cloud::ClosedLine& line, const cloud::ClosedLine& truth) {
  const evaluation::LineError error = evaluation::line_error(line, truth);
  outcome.error_mean_mm = error.mean_mm;
  outcome.error_p95_mm = error.p95_mm;
  outcome.error_max_mm = error.max_mm;
  outcome.complete = error.complete;
  const std::vector<LinePlace> places = places_of(line), true_places = places_of(truth);
  const double spacing_mm = cloud::length_mm(line) / static_cast<double>(line.points.size());
  std::size_t stated = 0, inside = 0;
  double wrong_mm = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double off_mm = distance_mm(places[i], true_places);
    const std::optional<double>& u95_mm = line.points[i].u95_mm;
    if (u95_mm) {
      ++stated;
      if (off_mm <= *u95_mm) ++inside;
    }
    if (off_mm > k_off_mm && (line.points[i].flags & cloud::k_line_unsure) == 0) wrong_mm += spacing_mm;
  }
  if (stated > 0) outcome.u95_inside = static_cast<double>(inside) / static_cast<double>(stated);
  outcome.wrong_mm = wrong_mm;
}

std::vector<LinePlace> places_of(const cloud::ClosedLine& line) {
  std::vector<LinePlace> places;
  places.reserve(line.points.size());
  for (const cloud::LinePoint& point : line.points) {
    const Eigen::Vector3f p = point.position.cast<float>();
    places.push_back({p.x(), p.y(), p.z(), static_cast<float>(point.u95_mm.value_or(-1))});
  }
  return places;
}

double distance_mm(const LinePlace& point, std::span<const LinePlace> line) {
  const auto vector = [](const LinePlace& p) {
    return Eigen::Vector3f{p.x_mm, p.y_mm, p.z_mm}.cast<double>().eval();
  };
  double least = std::numeric_limits<double>::infinity();
  const Vec3 p = vector(point);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Vec3 a = vector(line[i]);
    const Vec3 way = vector(line[(i + 1) % line.size()]) - a;
    const double squared = way.squaredNorm();
    const double part = squared > 0 ? std::clamp((p - a).dot(way) / squared, 0.0, 1.0) : 0;
    least = std::min(least, (a + part * way - p).norm());
  }
  return least;
}

}  // namespace biteline::batch
