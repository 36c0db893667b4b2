// SPDX-License-Identifier: MIT
#include "host/bite_line/finished_line.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::bite_line {

namespace {

/// That a point lies within 0.3 mm of the true line.
double point_confidence(const PlacedPoint& point, double of_line) {
  const double seen = 1.0 / (1.0 + point.doubt);
  // The section's own place against the mean over its neighbours: a groove that jumps by more than 0.3 mm is
  // unsure.
  const double calm = 1.0 / (1.0 + std::pow(point.scatter_mm / 0.6, 2));
  return of_line * seen * calm;
}

}  // namespace

void add_tangents(cloud::ClosedLine& line) {
  const std::size_t count = line.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 chord = line.points[(i + 1) % count].position - line.points[(i + count - 1) % count].position;
    if (chord.norm() > 1e-9) line.points[i].tangent = chord.normalized();
  }
}

cloud::ClosedLine finished_line(const Placement& placement, const Extraction& extraction, double spacing_mm) {
  const auto& placed = placement.points;
  std::vector<double> at(placed.size() + 1, 0.0);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    at[i + 1] = at[i] + (placed[(i + 1) % placed.size()].position - placed[i].position).norm();
  }
  const auto count = static_cast<std::size_t>(std::max(3.0, std::round(at.back() / spacing_mm)));
  cloud::ClosedLine line;
  line.points.reserve(count);
  std::size_t k = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double target = at.back() * static_cast<double>(i) / static_cast<double>(count);
    while (k + 1 < placed.size() && at[k + 1] <= target) ++k;
    const PlacedPoint& a = placed[k];
    const PlacedPoint& b = placed[(k + 1) % placed.size()];
    const double f = (target - at[k]) / std::max(at[k + 1] - at[k], 1e-12);
    const Vec3 position = (1 - f) * a.position + f * b.position;
    const Vec3 normal = ((1 - f) * a.normal + f * b.normal).normalized();
    const double confidence =
        (1 - f) * point_confidence(a, extraction.confidence) + f * point_confidence(b, extraction.confidence);
    line.points.push_back({.position = extraction.T_base_shoe * position,
                           .normal = extraction.T_base_shoe.linear() * normal,
                           .tangent = Vec3::UnitX(),
                           .confidence = confidence});
  }
  add_tangents(line);
  return line;
}

Candidate candidate_of(const Crease& crease, double confidence, const Side& side) {
  const SideField& field = side.field;
  const Outline& outline = side.outline;
  const SideGrid& grid = field.grid;
  Candidate candidate{.confidence = confidence,
                      .mean_height_mm = crease.mean_height_mm,
                      .length_mm = 0,
                      .closure_mm = crease.closure_mm,
                      .crease_deg = crease.median_turn_rad * 180.0 / 3.14159265358979,
                      .seen_share = crease.seen_share,
                      .points = {}};
  for (int c = 0; c < grid.cols; ++c) {
    const int row =
        std::clamp(static_cast<int>(std::lround(crease.row[static_cast<std::size_t>(c)])), 0, grid.rows - 1);
    const double s = (c + 0.5) * grid.col_mm;
    const Vec2 plan = outline.point(s) + static_cast<double>(field.o_mm[grid.at(row, c)]) * outline.normal(s);
    candidate.points.push_back(side.shoe.T_base_shoe *
                               Vec3{plan.x(), plan.y(), grid.z_mm(crease.row[static_cast<std::size_t>(c)])});
  }
  for (std::size_t i = 0; i < candidate.points.size(); ++i) {
    candidate.length_mm += (candidate.points[(i + 1) % candidate.points.size()] - candidate.points[i]).norm();
  }
  return candidate;
}

}  // namespace biteline::bite_line
