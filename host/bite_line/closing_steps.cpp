// SPDX-License-Identifier: MIT
#include "host/bite_line/closing_steps.hpp"

#include <algorithm>
#include <utility>

#include "host/bite_line/finished_line.hpp"
#include "host/bite_line/path/creases.hpp"
#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/published/stage_products.hpp"
#include "host/bite_line/published/thin.hpp"
#include "host/bite_line/published/trace.hpp"

namespace biteline::bite_line {

namespace {

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
      cloud::ClosedLine line;
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
    extraction.length_mm = cloud::length_mm(extraction.line);
    extraction.found = extraction.line.points.size() >= 3;
  }
  if (!extraction.found) {
    extraction.line = {};
    extraction.reason =
        traced.reason.empty() ? "no crease: too few points along the traced line" : traced.reason;
  }
  if (config.keep_products) {
    extraction.products.plain_svd_features =
        clock.run("plain SVD", [&] { return plain_svd_features(side, config); });
    hand_on(std::move(stages), extraction.products, cloud, extraction.T_base_shoe, traced.path_row);
  }
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

void find_line(const Side& side, const cloud::PointCloud& cloud, const ExtractConfig& config,
               const RawNear& raw_near, StageClock& clock, Extraction& extraction) {
  if (config.method == Method::Published) {
    extract_published(side, cloud, config, clock, extraction);
  } else {
    extract_ours(side, cloud, config, raw_near, clock, extraction);
  }
}

}  // namespace biteline::bite_line
