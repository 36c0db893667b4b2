// SPDX-License-Identifier: MIT
#include "host/bite_line/level/along_guide.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/bite_line/layers/climb.hpp"
#include "host/bite_line/level/detours.hpp"
#include "host/bite_line/level/levelled.hpp"
#include "host/bite_line/level/place_along.hpp"
#include "host/bite_line/side/side_outline.hpp"

namespace biteline::bite_line {

namespace {

std::size_t nearest(std::span<const Vec2> places, const Vec2& to, double turn_mm) {
  const auto off = [&](const Vec2& place) {
    const double s = place.x() - to.x();
    return Vec2{s - turn_mm * std::round(s / turn_mm), place.y() - to.y()}.squaredNorm();
  };
  return static_cast<std::size_t>(std::ranges::min_element(places, {}, off) - places.begin());
}

/// What speaks against the guide speaks against the line.
void doubt_guide(const Guide& guide, const Levelled& levelled, const SideGrid& grid, double turn_mm,
                 Layers& layers) {
  if (guide.hold.empty()) return;
  for (int c = 0; c < grid.cols; ++c) {
    const std::size_t at = nearest(guide.places, levelled.place((c + 0.5) * grid.col_mm), turn_mm);
    const auto col = static_cast<std::size_t>(c);
    if (!(guide.hold[at] < layers.hold[col])) continue;
    layers.hold[col] = guide.hold[at];
    layers.other_mm[col] = guide.other_mm[at];
  }
}

/// A path that leaves the guide lies on another crease: two ways to look do not agree.
void doubt_apart(const Levelled& levelled, const SideGrid& grid, Layers& layers) {
  const double apart_mm = DetourConfig{}.apart_mm;
  const float unsure = LayersConfig{}.changed_hold;
  for (std::size_t col = 0; col < layers.hold.size(); ++col) {
    const double off_mm = std::abs(grid.z_mm(layers.line.row[col]) - levelled.height_mm());
    if (off_mm < apart_mm || layers.hold[col] <= unsure) continue;
    layers.hold[col] = unsure;
    layers.other_mm[col] = static_cast<float>(off_mm);
  }
}

}  // namespace

AlongGuide find_along_guide(const ScanPoints& scan, const Side& side, const Guide& guide,
                            const std::optional<SeamStep>& seam, const Config& config) {
  AlongGuide found;
  const double turn_mm = side.outline.length_mm();
  const OrRefusal<Levelled> levelled =
      Levelled::along(side, smooth_guide(guide.places, turn_mm, k_guide_sigma_mm));
  if (!levelled) {
    found.decision.refusal = levelled.error();
    return found;
  }
  Side level = side_along(*levelled);
  // The guide has climbed already: what is left is small.
  const LayersConfig nearly_level{.evidence = {.thin_soles = true},
                                  .course = {.path = {.max_step_rows = 4, .step_cost = 0.3}}};
  Layers layers = find_layers_along(level, nearly_level, scan.looks);
  doubt_guide(guide, *levelled, level.field.grid, turn_mm, layers);
  doubt_apart(*levelled, level.field.grid, layers);
  found.decision = decide(layers, plan_shape(side_reach(side)), seam, config.min_confidence_ratio);
  if (!found.decision.refusal || found.decision.for_review) {
    OrRefusal<PlacedLine> placed = place_along(scan, side,
                                               {.levelled = *levelled,
                                                .grid = level.field.grid,
                                                .path_row = found.decision.paths.front().row,
                                                .layers = layers},
                                               config.point_spacing_mm);
    if (placed) {
      found.placed = std::move(*placed);
    } else {
      found.decision.refusal = placed.error();
      found.decision.for_review = false;
    }
  }
  for (JudgedPath& path : found.decision.paths) path.row = levelled->back(level.field, path.row);
  return found;
}

}  // namespace biteline::bite_line
