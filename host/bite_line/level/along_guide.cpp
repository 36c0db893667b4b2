// SPDX-License-Identifier: MIT
#include "host/bite_line/level/along_guide.hpp"

#include <utility>

#include "host/bite_line/layers/climb.hpp"
#include "host/bite_line/level/levelled.hpp"
#include "host/bite_line/place/place_path.hpp"
#include "host/bite_line/side/side_outline.hpp"

namespace biteline::bite_line {

AlongGuide find_along_guide(const ScanPoints& scan, const Side& side, std::span<const Vec2> guide,
                            const std::optional<SeamStep>& seam, const Config& config) {
  const Levelled levelled{side, guide};
  Shoe shoe = levelled.shoe();
  SideField field = SideField::build(shoe, levelled.outline(), {});
  Side level{std::move(shoe), levelled.outline(), std::move(field)};
  // The guide has climbed already: what is left is small.
  const LayersConfig nearly_level{.course = {.path = {.max_step_rows = 4, .step_cost = 0.3}}};
  const Layers layers = find_layers_along(level, nearly_level, scan.looks);
  AlongGuide found{
      .decision = decide(layers, plan_shape(side_reach(side)), seam, config.min_confidence_ratio),
      .placed = {}};
  if (!found.decision.refusal) {
    const Large<Eigen::Vector3f> points = levelled.points(scan.points);
    ScanPoints on_level = scan;
    on_level.points = points;
    found.placed = levelled.back(place_path(
        on_level, level, found.decision.paths.front().row,
        {.hold = layers.hold, .other_mm = layers.other_mm, .sharp = layers.sharp}, config.point_spacing_mm));
  }
  for (JudgedPath& path : found.decision.paths) path.row = levelled.back(level.field, path.row);
  return found;
}

}  // namespace biteline::bite_line
