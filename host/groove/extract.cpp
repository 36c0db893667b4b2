// SPDX-License-Identifier: MIT
#include "host/groove/extract.hpp"

#include <functional>
#include <optional>
#include <utility>

#include "host/groove/finished_line.hpp"
#include "host/groove/path/creases.hpp"
#include "host/groove/path/decide.hpp"
#include "host/groove/place/placement.hpp"
#include "host/groove/published/stage_products.hpp"
#include "host/groove/published/thin.hpp"
#include "host/groove/published/trace.hpp"
#include "host/groove/side/side.hpp"
#include "host/groove/stage_clock.hpp"

namespace biteline::groove {

namespace {

/// Points for the line's place, in shoe; how many there are for each point of the side.
struct RawPoints {
  std::vector<Eigen::Vector3f> points;
  double per_side_point{1};
};
/// The raw points behind points of the side, given by their indices.
using RawNear = std::function<RawPoints(const std::vector<std::uint32_t>&)>;

/// method.md 7 to 10 as published.
void extract_published(const Side& side, const cloud::PointCloud& cloud, const ExtractConfig& config,
                       StageClock& clock, Extraction& extraction) {
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
      for (const Vec3& p :
           published::even_sequence(thin_line(stages, traced.path_row, coarse), config.point_spacing_mm)) {
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
    extraction.reason =
        traced.reason.empty() ? "no crease: too few points along the traced line" : traced.reason;
  }
  if (config.keep_products)
    hand_on(std::move(stages), extraction.products, cloud, extraction.T_base_shoe, traced.path_row);
}

void extract_ours(const Side& side, const cloud::PointCloud& cloud, const ExtractConfig& config,
                  const RawNear& raw_near, StageClock& clock, Extraction& extraction) {
  const std::vector<Crease> creases = clock.run("path", [&] { return find_creases(side.field, {}); });
  const Decision decision = decide(creases, config.min_confidence_ratio);
  for (const std::size_t i : decision.order) {
    extraction.candidates.push_back(candidate_of(creases[i], decision.confidence_of[i], side));
  }
  extraction.confidence = decision.confidence;
  if (decision.accepted) {
    const Crease& best = creases[decision.best];
    const Placement placement = clock.run("placement", [&] {
      const RawPoints raw = raw_near(near_path(side.field, best));
      return place_line({.near = raw.points,
                         .points_per_mm2 = side.field.points_per_mm2 * raw.per_side_point,
                         .field = side.field,
                         .outline = side.outline,
                         .crease = best},
                        {.spacing_mm = config.point_spacing_mm});
    });
    extraction.line = finished_line(placement, extraction, config.point_spacing_mm);
    extraction.length_mm = placement.length_mm;
    extraction.bridged_mm = placement.bridged_mm;
    // What was bridged was not seen to be the bite line.
    extraction.confidence =
        decision.confidence * (1 - placement.bridged_mm / std::max(placement.length_mm, 1.0));
    extraction.closure_mm = best.closure_mm;
    extraction.found = true;
  } else {
    extraction.reason = decision.reason;
  }
  if (!config.keep_products) return;
  Stages stages = run_stages(side, config, clock);
  std::vector<float> path_row(static_cast<std::size_t>(stages.picture.cols), -1.0F);
  if (extraction.found)
    path_row = row_per_column(extraction.line, extraction.T_base_shoe, stages.picture, stages.sections);
  hand_on(std::move(stages), extraction.products, cloud, extraction.T_base_shoe, std::move(path_row));
}

}  // namespace

Extraction extract(const cloud::PointCloud& cloud, const ExtractConfig& config,
                   const StageCallback& on_stage) {
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
  // Neighbours along the stripe are some 0.07 mm apart: their means over a quarter of a millimetre carry all
  // that finding the line needs.
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
