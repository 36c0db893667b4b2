// SPDX-License-Identifier: MIT
#include "host/bite_line/find_bite_line.hpp"

#include <utility>
#include <vector>

#include "host/bite_line/layers/climb.hpp"
#include "host/bite_line/level/along_guide.hpp"
#include "host/bite_line/level/detours.hpp"
#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/place/finish.hpp"
#include "host/bite_line/place/place_path.hpp"
#include "host/bite_line/side/seam.hpp"
#include "host/bite_line/side/side_outline.hpp"

namespace biteline::bite_line {

Extraction find_bite_line(const ScanPoints& scan, const Config& config, std::optional<Workings>* workings) {
  report::StageClock clock;
  OrRefusal<Shoe> shoe = clock.run("shoe", [&] { return find_shoe(scan.means); });
  if (!shoe) return refused(shoe.error(), clock.take());
  Outline outline = clock.run("outline", [&] { return side_outline(*shoe); });
  SideField field = clock.run("side", [&] { return SideField::build(*shoe, outline, {}); });
  Side side{std::move(*shoe), std::move(outline), std::move(field)};
  Layers layers = clock.run("layers", [&] { return find_layers_along(side, {}, scan.looks); });
  const std::optional<SeamStep> seam =
      clock.run("seam", [&] { return seam_step(scan, side.shoe, side.outline); });
  const std::vector<Vec2> guide = clock.run("detours", [&] {
    const std::vector<Detour> detours = find_detours(side, layers, {});
    doubt_detours(side.field.grid, detours, layers);
    return guide_of(side, layers.line, detours);
  });
  Decision decision;
  PlacedLine placed;
  if (guide.empty()) {
    decision = clock.run("decision", [&] {
      return decide(layers, plan_shape(side_reach(side)), seam, config.min_confidence_ratio);
    });
    placed = clock.run("place", [&] {
      if (decision.refusal) return PlacedLine{};
      return place_path(scan, side, decision.paths.front().row,
                        {.hold = layers.hold, .other_mm = layers.other_mm, .sharp = layers.sharp},
                        config.point_spacing_mm);
    });
  } else {
    AlongGuide along = clock.run("level", [&] { return find_along_guide(scan, side, guide, seam, config); });
    decision = std::move(along.decision);
    placed = std::move(along.placed);
  }
  Extraction extraction = clock.run("finish", [&] {
    uncertainty::WholeScan whole{.head = {}, .arm = scan.arm};
    if (config.head != nullptr && !scan.poses.empty()) whole.head.emplace(*config.head, scan.poses);
    return finish(side, decision, placed, config, whole);
  });
  extraction.seam = seam;
  extraction.stages = clock.take();
  if (workings != nullptr)
    workings->emplace(Workings{std::move(side), std::move(decision), std::move(placed)});
  return extraction;
}

Extraction find_bite_line(const cloud::PointCloud& cloud, const Config& config,
                          std::optional<Workings>* workings) {
  const PointRuns runs = runs_of(cloud);
  return find_bite_line(runs.scan(cloud.points), config, workings);
}

}  // namespace biteline::bite_line
