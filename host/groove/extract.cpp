// SPDX-License-Identifier: MIT
#include "host/groove/extract.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "host/groove/creases.hpp"
#include "host/groove/decide.hpp"
#include "host/groove/placement.hpp"
#include "host/groove/plan.hpp"
#include "host/groove/shoe.hpp"
#include "host/groove/side_field.hpp"

namespace biteline::groove {

namespace {

class StageClock {
 public:
  StageClock(std::vector<Stage>& stages, const StageCallback& on_stage) : stages_{stages}, on_stage_{on_stage} {}

  template <class Work>
  auto run(const char* name, Work&& work) {
    if (on_stage_) on_stage_(name);
    const auto begin = std::chrono::steady_clock::now();
    auto result = work();
    stages_.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()});
    return result;
  }

 private:
  std::vector<Stage>& stages_;
  const StageCallback& on_stage_;
};

/// Plan of the lower side: hull of the points up to 45 mm above the lowest, which is where bite lines are.
Outline side_outline(const std::vector<Eigen::Vector3f>& points) {
  constexpr float k_band_mm = 45.0F;
  constexpr float k_cell_mm = 1.0F;
  float lowest = 1e9F;
  float reach = 0;
  for (const Eigen::Vector3f& p : points) {
    lowest = std::min(lowest, p.z());
    reach = std::max({reach, std::abs(p.x()), std::abs(p.y())});
  }
  // Only the outermost point of each row of the plan can lie on the hull.
  const auto half = static_cast<std::size_t>(reach / k_cell_mm) + 1;
  std::vector<std::pair<Vec2, Vec2>> ends(2 * half + 1, {Vec2{1e9, 0}, Vec2{-1e9, 0}});
  for (const Eigen::Vector3f& p : points) {
    if (p.z() > lowest + k_band_mm) continue;
    auto& [low, high] = ends[static_cast<std::size_t>(std::floor(p.y() / k_cell_mm) + static_cast<float>(half))];
    if (static_cast<double>(p.x()) < low.x()) low = p.head<2>().cast<double>();
    if (static_cast<double>(p.x()) > high.x()) high = p.head<2>().cast<double>();
  }
  std::vector<Vec2> plan;
  for (const auto& [low, high] : ends) {
    if (low.x() > 1e8) continue;
    plan.push_back(low);
    plan.push_back(high);
  }
  return Outline{convex_hull(std::move(plan)), {}};
}

Candidate candidate_of(const Crease& crease, double confidence, const SideField& field, const Outline& outline, const SE3& T_base_shoe) {
  const SideGrid& grid = field.grid;
  Candidate candidate{.confidence = confidence,
                      .mean_height_mm = crease.mean_height_mm,
                      .length_mm = 0,
                      .closure_mm = crease.closure_mm,
                      .crease_deg = crease.median_turn_rad * 180.0 / 3.14159265358979,
                      .seen_share = crease.seen_share,
                      .points = {}};
  for (int c = 0; c < grid.cols; ++c) {
    const int row = std::clamp(static_cast<int>(std::lround(crease.row[static_cast<std::size_t>(c)])), 0, grid.rows - 1);
    const double s = (c + 0.5) * grid.col_mm;
    const Vec2 plan = outline.point(s) + static_cast<double>(field.o_mm[grid.at(row, c)]) * outline.normal(s);
    candidate.points.push_back(T_base_shoe * Vec3{plan.x(), plan.y(), grid.z_mm(crease.row[static_cast<std::size_t>(c)])});
  }
  for (std::size_t i = 0; i < candidate.points.size(); ++i) {
    candidate.length_mm += (candidate.points[(i + 1) % candidate.points.size()] - candidate.points[i]).norm();
  }
  return candidate;
}

/// That a point lies within 0.3 mm of the true line.
double point_confidence(const PlacedPoint& point, double of_line) {
  // A bridged stretch is a straight guess between its ends: worth half after 8 mm.
  const double seen = std::exp2(-point.to_visible_mm / 8.0);
  // The section's own place against the mean over its neighbours: a groove that jumps by more than 0.3 mm is unsure.
  const double calm = 1.0 / (1.0 + std::pow(point.scatter_mm / 0.6, 2));
  return of_line * seen * calm;
}

/// Evenly spaced along the line, in base, with tangents.
line::ClosedLine finished_line(const Placement& placement, const Extraction& extraction, double spacing_mm) {
  const auto& placed = placement.points;
  std::vector<double> at(placed.size() + 1, 0.0);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    at[i + 1] = at[i] + (placed[(i + 1) % placed.size()].position - placed[i].position).norm();
  }
  const auto count = static_cast<std::size_t>(std::max(3.0, std::round(at.back() / spacing_mm)));
  line::ClosedLine line;
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
    const double confidence = (1 - f) * point_confidence(a, extraction.confidence) + f * point_confidence(b, extraction.confidence);
    line.points.push_back({.position = extraction.T_base_shoe * position,
                           .normal = extraction.T_base_shoe.linear() * normal,
                           .tangent = Vec3::UnitX(),
                           .confidence = confidence});
  }
  for (std::size_t i = 0; i < count; ++i) {
    line.points[i].tangent = (line.points[(i + 1) % count].position - line.points[(i + count - 1) % count].position).normalized();
  }
  return line;
}

}  // namespace

Extraction extract(const cloud::PointCloud& cloud, const ExtractConfig& config, const StageCallback& on_stage) {
  Extraction extraction;
  if (config.method == Method::Published) {
    extraction.reason = "the published method is not part of this build";
    return extraction;
  }
  StageClock clock{extraction.stages, on_stage};
  const Shoe shoe = clock.run("shoe", [&] { return find_shoe(cloud.points); });
  extraction.T_base_shoe = shoe.T_base_shoe;
  if (!shoe.found) {
    extraction.reason = shoe.reason;
    return extraction;
  }
  const Outline outline = clock.run("outline", [&] { return side_outline(shoe.points); });
  const SideField field = clock.run("unroll", [&] { return SideField::build(shoe.points, outline, {}); });
  const std::vector<Crease> creases = clock.run("path", [&] { return find_creases(field, {}); });
  const Decision decision = decide(creases, config.min_confidence_ratio);
  for (const std::size_t i : decision.order) {
    extraction.candidates.push_back(candidate_of(creases[i], decision.confidence_of[i], field, outline, shoe.T_base_shoe));
  }
  extraction.confidence = decision.confidence;
  if (!decision.accepted) {
    extraction.reason = decision.reason;
    return extraction;
  }
  const Crease& best = creases[decision.best];
  const Placement placement = clock.run("placement", [&] { return place_line(shoe.points, field, outline, best, {.spacing_mm = config.point_spacing_mm}); });
  extraction.line = finished_line(placement, extraction, config.point_spacing_mm);
  extraction.length_mm = placement.length_mm;
  extraction.bridged_mm = placement.bridged_mm;
  extraction.closure_mm = best.closure_mm;
  extraction.found = true;
  return extraction;
}

}  // namespace biteline::groove
