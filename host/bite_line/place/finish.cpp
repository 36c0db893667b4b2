// SPDX-License-Identifier: MIT
#include "host/bite_line/place/finish.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

/// That a point lies within 0.3 mm of the true line.
double point_confidence(const PlacedStation& point, double of_line) {
  const double seen = 1.0 / (1.0 + point.doubt);
  // The section's own place against the mean over its neighbours: a groove that jumps by more than 0.3 mm is
  // unsure.
  const double scatter_mm = std::abs(point.own_z_mm - point.position.z());
  const double calm = 1.0 / (1.0 + std::pow(scatter_mm / 0.6, 2));
  return of_line * point.trust * seen * calm;
}

/// Evenly spaced along the placed line, in base, with tangents.
cloud::ClosedLine even_line(const PlacedLine& placed_line, const SE3& T_base_shoe, double of_line,
                            double spacing_mm) {
  const auto& placed = placed_line.points;
  const geometry::ArcLength along{placed.size(), [&](std::size_t i) { return placed[i].position; }};
  const std::size_t count = along.count_for(spacing_mm);
  cloud::ClosedLine line;
  line.points.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const geometry::OnCurve at = along.even(k, count);
    const PlacedStation& a = placed[at.before];
    const PlacedStation& b = placed[at.after];
    line.points.push_back(
        {.position = T_base_shoe * at.between<Vec3>(a.position, b.position),
         .normal = T_base_shoe.linear() * at.between<Vec3>(a.normal, b.normal).normalized(),
         .tangent = Vec3::UnitX(),
         .confidence = at.between(point_confidence(a, of_line), point_confidence(b, of_line))});
  }
  add_tangents(line);
  return line;
}

/// A line with more than this below the limit is none: a tool would work beside the bite line there.
constexpr double k_most_unsure_share = 0.1;

double unsure_share(const cloud::ClosedLine& line, double min_confidence) {
  const auto unsure = std::count_if(line.points.begin(), line.points.end(), [&](const cloud::LinePoint& p) {
    return !(p.confidence >= min_confidence);
  });
  return static_cast<double>(unsure) / static_cast<double>(std::max<std::size_t>(line.points.size(), 1));
}

Candidate candidate_of(const JudgedPath& path, const Side& side) {
  const SideField& field = side.field;
  const Outline& outline = side.outline;
  const SideGrid& grid = field.grid;
  Candidate candidate{.confidence = path.confidence,
                      .mean_height_mm = path.mean_height_mm,
                      .length_mm = 0,
                      .closure_mm = path.closure_mm,
                      .crease_deg = path.turn_rad * 180.0 / std::numbers::pi,
                      .seen_share = path.seen_share,
                      .points = {}};
  for (int c = 0; c < grid.cols; ++c) {
    const double path_row = path.row[static_cast<std::size_t>(c)];
    const int row = std::clamp(static_cast<int>(std::lround(path_row)), 0, grid.rows - 1);
    const double s = (c + 0.5) * grid.col_mm;
    const Vec2 plan = outline.point(s) + static_cast<double>(field.o_mm[grid.at(row, c)]) * outline.normal(s);
    candidate.points.push_back(side.shoe.T_base_shoe * Vec3{plan.x(), plan.y(), grid.z_mm(path_row)});
  }
  candidate.length_mm = geometry::ArcLength{
      candidate.points.size(), [&](std::size_t i) {
        return candidate.points[i];
      }}.total_mm();
  return candidate;
}

}  // namespace

void add_tangents(cloud::ClosedLine& line) {
  const std::size_t count = line.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 chord = line.points[(i + 1) % count].position - line.points[(i + count - 1) % count].position;
    if (chord.norm() > 1e-9) line.points[i].tangent = chord.normalized();
  }
}

Extraction finish(const Side& side, const Decision& decision, const PlacedLine& placed,
                  const Config& config) {
  Extraction out{.confidence = decision.confidence, .T_base_shoe = side.shoe.T_base_shoe};
  for (const JudgedPath& path : decision.paths) out.candidates.push_back(candidate_of(path, side));
  out.refusal = decision.refusal;
  if (out.refusal) return out;
  const double bridged_share = placed.bridged_mm / std::max(placed.length_mm, 1.0);
  out.confidence = decision.confidence * (1 - bridged_share);
  out.closure_mm = decision.paths.front().closure_mm;
  out.length_mm = placed.length_mm;
  out.bridged_mm = placed.bridged_mm;
  if (!(out.confidence >= config.min_confidence_ratio)) {
    out.refusal = Refusal{Refused::TooMuchBridged,
                          FixedText<200>::format("too much was not seen: %.0f of %.0f mm are bridged, which "
                                                 "leaves a confidence of %.2f (at least %.2f)",
                                                 placed.bridged_mm, placed.length_mm, out.confidence,
                                                 config.min_confidence_ratio)
                              .c_str()};
    return out;
  }
  out.line = even_line(placed, side.shoe.T_base_shoe, decision.of_line, config.point_spacing_mm);
  const double unsure = unsure_share(out.line, config.min_confidence_ratio);
  out.confidence = std::min(out.confidence, 1 - unsure);
  if (unsure > k_most_unsure_share) {
    out.line = {};
    out.confidence = std::min(out.confidence, 0.99 * config.min_confidence_ratio);
    out.refusal =
        Refusal{Refused::TooMuchUnsure,
                FixedText<200>::format("%.0f %% of the line's length is unsure (at most %.0f %%); %.0f mm "
                                       "were not seen and are bridged",
                                       100 * unsure, 100 * k_most_unsure_share, placed.bridged_mm)
                    .c_str()};
    return out;
  }
  out.found = true;
  return out;
}

Extraction refused(Refusal refusal, std::vector<report::StageTime> stages) {
  return {.refusal = std::move(refusal), .stages = std::move(stages)};
}

}  // namespace biteline::bite_line
