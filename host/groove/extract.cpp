// SPDX-License-Identifier: MIT
#include "host/groove/extract.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <span>

#include "host/groove/creases.hpp"
#include "host/groove/decide.hpp"
#include "host/groove/placement.hpp"
#include "host/groove/plan.hpp"
#include "host/groove/published/thin.hpp"
#include "host/groove/published/trace.hpp"
#include "host/groove/shoe.hpp"
#include "host/groove/side_field.hpp"
#include "host/groove/surface.hpp"

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

void add_tangents(line::ClosedLine& line) {
  const std::size_t count = line.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 chord = line.points[(i + 1) % count].position - line.points[(i + count - 1) % count].position;
    if (chord.norm() > 1e-9) line.points[i].tangent = chord.normalized();
  }
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
  add_tangents(line);
  return line;
}

/// Points for the line's place, in shoe; how many there are for each point of the side.
struct RawPoints {
  std::vector<Eigen::Vector3f> points;
  double per_side_point{1};
};
/// The raw points behind points of the side, given by their indices.
using RawNear = std::function<RawPoints(const std::vector<std::uint32_t>&)>;

/// What both methods start from.
struct Side {
  Shoe shoe;
  Outline outline;
  SideField field;
};

EightSections sections_of(const Shoe& shoe) { return EightSections{{.length_mm = shoe.length_mm, .half_width_mm = 0.5 * shoe.width_mm}}; }

/// Row of the eight-section picture for every column that the line passes, straight in between.
std::vector<float> row_per_column(const line::ClosedLine& line, const SE3& T_base_shoe, const Unrolled& picture, const EightSections& sections) {
  std::vector<double> sum(static_cast<std::size_t>(picture.cols), 0.0);
  std::vector<int> count(sum.size(), 0);
  const SE3 T_shoe_base = T_base_shoe.inverse();
  for (const line::LinePoint& point : line.points) {
    const Vec3 p = T_shoe_base * point.position;
    const auto col = static_cast<std::size_t>(std::clamp(static_cast<int>(sections.along_mm(p.x(), p.y()) / picture.col_mm), 0, picture.cols - 1));
    sum[col] += (picture.top_mm - p.z()) / picture.row_mm - 0.5;
    ++count[col];
  }
  std::vector<float> row(sum.size(), -1.0F);
  float last = -1.0F;
  for (std::size_t pass = 0; pass < 2; ++pass) {
    for (std::size_t c = 0; c < sum.size(); ++c) {
      if (count[c] > 0) last = static_cast<float>(sum[c] / count[c]);
      if (row[c] < 0) row[c] = last;
      if (count[c] > 0) row[c] = last;
    }
  }
  return row;
}

/// Points and pictures of the stages, and the thick line around `path_row`.
struct Stages {
  CurvedSurface surface;
  std::vector<std::uint32_t> features;
  std::vector<std::uint32_t> denoised_features;
  EightSections sections;
  Unrolled picture;
};

Stages run_stages(const Side& side, const ExtractConfig& config, StageClock& clock) {
  const curvature::CurvatureConfig curvature_config{
      .solver = config.method == Method::Published ? curvature::Solver::WeightedPca : curvature::Solver::LeastSquares,
      .radius_mm = static_cast<float>(config.curvature_radius_mm)};
  CurvedSurface surface = clock.run("curvature", [&] { return curve_surface(side.shoe, side.field, side.outline, config.surface_point_limit, curvature_config); });
  std::vector<std::uint32_t> features = clock.run("features", [&] { return feature_points(surface, {}); });
  std::vector<std::uint32_t> kept = clock.run("denoise", [&] { return denoised(surface, features, {}); });
  const EightSections sections = sections_of(side.shoe);
  Unrolled picture = clock.run("eight sections", [&] { return unroll_features(surface, kept, sections); });
  return {std::move(surface), std::move(features), std::move(kept), sections, std::move(picture)};
}

/// The article's last steps: back to 3-D, thinning, sequence.  Thick points wander across the groove, so the line through
/// each must be fitted over several millimetres: lambda grows with the points per millimetre.
std::vector<Vec3> thin_line(const Stages& stages, std::span<const float> path_row, std::vector<std::uint32_t>& coarse) {
  constexpr double k_reach_mm = 1.5;
  coarse = published::back_project(stages.surface.points, stages.denoised_features, stages.picture, stages.sections, path_row, k_reach_mm);
  std::vector<Vec3> points;
  points.reserve(coarse.size());
  for (const std::uint32_t i : coarse) points.push_back(stages.surface.points[i].cast<double>());
  const double per_mm = static_cast<double>(points.size()) / stages.sections.perimeter_mm();
  return published::thin(std::move(points), {.lambda = std::max(10, static_cast<int>(4.0 * per_mm))});
}

void keep_products(Products& products, Stages&& stages, const cloud::PointCloud& cloud, const SE3& T_base_shoe, std::vector<float> path_row) {
  std::vector<Vec3> thinned = thin_line(stages, path_row, products.coarse_line);
  for (Vec3& p : thinned) p = T_base_shoe * p;
  products.thinned_line = std::move(thinned);
  const Eigen::Matrix3f R_base_shoe = T_base_shoe.linear().cast<float>();
  products.surface.points.reserve(stages.surface.index.size());
  products.surface.normals = std::move(stages.surface.curvature.normal);
  for (Eigen::Vector3f& normal : products.surface.normals) normal = R_base_shoe * normal;
  for (const std::uint32_t i : stages.surface.index) products.surface.points.push_back(cloud.points[i]);
  products.mean_curvature_per_mm = std::move(stages.surface.curvature.mean_per_mm);
  products.gaussian_curvature_per_mm2 = std::move(stages.surface.curvature.gaussian_per_mm2);
  products.feature_points = std::move(stages.features);
  products.denoised_points = std::move(stages.denoised_features);
  // The picture shows all of the mean curvature, not only the features.
  std::vector<Eigen::Vector3f>& points = stages.surface.points;
  products.unrolled = unroll(points, products.mean_curvature_per_mm, stages.sections, {});
  products.path_row = std::move(path_row);
}

/// The upper's normal beside the line, from the height field: mean over 2 to 6 mm above.
Vec3 normal_from_field(const Side& side, const Vec3& p) {
  const SideGrid& grid = side.field.grid;
  const auto foot = side.outline.locate(static_cast<float>(p.x()), static_cast<float>(p.y()));
  const Vec2 out = side.outline.normal(static_cast<double>(foot.s_mm));
  const Vec2 along{-out.y(), out.x()};
  const int col = static_cast<int>(static_cast<double>(foot.s_mm) / grid.col_mm) % grid.cols;
  const int row = static_cast<int>((p.z() - grid.z_low_mm) / grid.row_mm);
  const auto rows_of = [&](double mm) { return static_cast<int>(mm / grid.row_mm); };
  Vec3 sum = 1e-3 * Vec3{out.x(), out.y(), 0};
  for (int r = std::max(1, row + rows_of(2.0)); r <= std::min(grid.rows - 2, row + rows_of(6.0)); ++r) {
    const auto o = [&](int dr, int dc) { return static_cast<double>(side.field.o_mm[grid.at(r + dr, (col + dc + grid.cols) % grid.cols)]); };
    const auto seen = [&](int dr, int dc) { return side.field.seen[grid.at(r + dr, (col + dc + grid.cols) % grid.cols)] != 0; };
    if (!seen(1, 0) || !seen(-1, 0) || !seen(0, 2) || !seen(0, -2)) continue;
    Vec3 normal{0, 0, -(o(1, 0) - o(-1, 0)) / (2 * grid.row_mm)};
    const double stretch = std::max(0.3, 1.0 + side.outline.bend_per_mm(static_cast<double>(foot.s_mm)) * o(0, 0));
    normal.head<2>() = out - (o(0, 2) - o(0, -2)) / (4 * grid.col_mm * stretch) * along;
    sum += normal.normalized();
  }
  return sum.normalized();
}

/// method.md 7 to 10 as published.
void extract_published(const Side& side, const cloud::PointCloud& cloud, const ExtractConfig& config, StageClock& clock, Extraction& extraction) {
  Stages stages = run_stages(side, config, clock);
  const published::TracedLine traced = clock.run("trace", [&] {
    return published::join_segments(stages.picture, published::trace_segments(stages.picture, {}), {});
  });
  extraction.closure_mm = traced.closure_mm;
  extraction.confidence = traced.covered_ratio;
  if (traced.closed) {
    extraction.line = clock.run("thin", [&] {
      std::vector<std::uint32_t> coarse;
      line::ClosedLine line;
      for (const Vec3& p : published::even_sequence(thin_line(stages, traced.path_row, coarse), config.point_spacing_mm)) {
        line.points.push_back({.position = extraction.T_base_shoe * p,
                               .normal = extraction.T_base_shoe.linear() * normal_from_field(side, p),
                               .tangent = Vec3::UnitX(),
                               .confidence = traced.covered_ratio});
      }
      add_tangents(line);
      return line;
    });
    extraction.length_mm = line::length_mm(extraction.line);
    extraction.found = extraction.line.points.size() >= 3;
  }
  if (!extraction.found) {
    extraction.line = {};
    extraction.reason = traced.reason.empty() ? "no crease: too few points along the traced line" : traced.reason;
  }
  if (config.keep_products) keep_products(extraction.products, std::move(stages), cloud, extraction.T_base_shoe, traced.path_row);
}

void extract_ours(const Side& side, const cloud::PointCloud& cloud, const ExtractConfig& config, const RawNear& raw_near, StageClock& clock, Extraction& extraction) {
  const std::vector<Crease> creases = clock.run("path", [&] { return find_creases(side.field, {}); });
  const Decision decision = decide(creases, config.min_confidence_ratio);
  for (const std::size_t i : decision.order) {
    extraction.candidates.push_back(candidate_of(creases[i], decision.confidence_of[i], side.field, side.outline, extraction.T_base_shoe));
  }
  extraction.confidence = decision.confidence;
  if (decision.accepted) {
    const Crease& best = creases[decision.best];
    const Placement placement = clock.run("placement", [&] {
      const RawPoints raw = raw_near(near_path(side.field, best));
      return place_line({.near = raw.points, .points_per_mm2 = side.field.points_per_mm2 * raw.per_side_point, .field = side.field, .outline = side.outline, .crease = best},
                        {.spacing_mm = config.point_spacing_mm});
    });
    extraction.line = finished_line(placement, extraction, config.point_spacing_mm);
    extraction.length_mm = placement.length_mm;
    extraction.bridged_mm = placement.bridged_mm;
    // What was bridged was not seen to be the bite line.
    extraction.confidence = decision.confidence * (1 - placement.bridged_mm / std::max(placement.length_mm, 1.0));
    extraction.closure_mm = best.closure_mm;
    extraction.found = true;
  } else {
    extraction.reason = decision.reason;
  }
  if (!config.keep_products) return;
  Stages stages = run_stages(side, config, clock);
  std::vector<float> path_row(static_cast<std::size_t>(stages.picture.cols), -1.0F);
  if (extraction.found) path_row = row_per_column(extraction.line, extraction.T_base_shoe, stages.picture, stages.sections);
  keep_products(extraction.products, std::move(stages), cloud, extraction.T_base_shoe, std::move(path_row));
}

/// Shoe, outline and height field of a cloud; nothing, and the reason in the extraction, when there is no shoe.
std::optional<Side> make_side(std::span<const Eigen::Vector3f> points, StageClock& clock, Extraction& extraction) {
  Shoe shoe = clock.run("shoe", [&] { return find_shoe(points); });
  extraction.T_base_shoe = shoe.T_base_shoe;
  if (!shoe.found) {
    extraction.reason = shoe.reason;
    return std::nullopt;
  }
  Outline outline = clock.run("outline", [&] { return side_outline(shoe.points); });
  SideField field = clock.run("unroll", [&] { return SideField::build(shoe.points, outline, {}); });
  return Side{std::move(shoe), std::move(outline), std::move(field)};
}

}  // namespace

Extraction extract(const cloud::PointCloud& cloud, const ExtractConfig& config, const StageCallback& on_stage) {
  Extraction extraction;
  StageClock clock{extraction.stages, on_stage};
  const std::optional<Side> side = make_side(cloud.points, clock, extraction);
  if (!side) return extraction;
  if (config.method == Method::Published) {
    extract_published(*side, cloud, config, clock, extraction);
    return extraction;
  }
  const RawNear raw_near = [&](const std::vector<std::uint32_t>& near) {
    RawPoints raw;
    raw.points.reserve(near.size());
    for (const std::uint32_t i : near) raw.points.push_back(side->shoe.points[i]);
    return raw;
  };
  extract_ours(*side, cloud, config, raw_near, clock, extraction);
  return extraction;
}

void LiveScan::add_profile(std::span<const Eigen::Vector3f> points) {
  // Neighbours along the stripe are some 0.07 mm apart: their means over a quarter of a millimetre carry all that finding
  // the line needs.
  constexpr float k_run_mm = 0.25F;
  std::size_t i = 0;
  while (i < points.size()) {
    const auto first = static_cast<std::uint32_t>(raw_.size());
    const Eigen::Vector3f start = points[i];
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float count = 0;
    for (; i < points.size() && (points[i] - start).squaredNorm() < k_run_mm * k_run_mm; ++i) {
      sum += points[i] - start;
      count += 1;
      raw_.push_back(points[i]);
    }
    thinned_.points.push_back(start + sum / count);
    first_raw_.push_back(first);
  }
}

Extraction LiveScan::finish(const ExtractConfig& config, const StageCallback& on_stage) const {
  Extraction extraction;
  StageClock clock{extraction.stages, on_stage};
  const std::optional<Side> side = make_side(thinned_.points, clock, extraction);
  if (!side) return extraction;
  const RawNear raw_near = [&](const std::vector<std::uint32_t>& near) {
    RawPoints raw;
    raw.per_side_point = static_cast<double>(raw_.size()) / static_cast<double>(thinned_.size());
    raw.points.reserve(static_cast<std::size_t>(1.2 * raw.per_side_point * static_cast<double>(near.size())));
    const Eigen::Isometry3f T_shoe_base = side->shoe.T_base_shoe.inverse().cast<float>();
    for (const std::uint32_t i : near) {
      const std::uint32_t run = side->shoe.index[i];
      const std::size_t end = run + 1 < first_raw_.size() ? first_raw_[run + 1] : raw_.size();
      for (std::size_t k = first_raw_[run]; k < end; ++k) raw.points.push_back(T_shoe_base * raw_[k]);
    }
    return raw;
  };
  if (config.method == Method::Published) {
    extract_published(*side, thinned_, config, clock, extraction);
  } else {
    extract_ours(*side, thinned_, config, raw_near, clock, extraction);
  }
  return extraction;
}

}  // namespace biteline::groove
