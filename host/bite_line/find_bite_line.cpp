// SPDX-License-Identifier: MIT
#include "host/bite_line/find_bite_line.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "host/bite_line/layers/climb.hpp"
#include "host/bite_line/level/along_guide.hpp"
#include "host/bite_line/level/detours.hpp"
#include "host/bite_line/level/way_round.hpp"
#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/place/finish.hpp"
#include "host/bite_line/place/place_path.hpp"
#include "host/bite_line/side/seam.hpp"
#include "host/bite_line/side/side_outline.hpp"

namespace biteline::bite_line {

namespace {

bool changes_crease(const Layers& layers, const Refusal& refusal) {
  const bool unsure = refusal.code == Refused::Rivalled || refusal.code == Refused::TooMuchUnsure;
  return unsure && !layers.others.empty();
}

/// A course over columns climbs by 45 degrees at most, and the shank of a high heel by more.
bool climbs_steeply(const SideGrid& grid, const Layers& layers) {
  constexpr float k_steep = 0.75F;
  return std::ranges::any_of(climb_of(grid, layers.line.row), [](float c) { return std::abs(c) > k_steep; });
}

}  // namespace

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
  const Guide guide = clock.run("detours", [&] {
    const std::vector<Detour> detours = find_detours(side, layers, {});
    doubt_detours(side.field.grid, detours, layers);
    return Guide{.places = guide_of(side, layers.line, detours)};
  });
  const auto look_along = [&](const Guide& by) {
    return clock.run("level", [&] { return find_along_guide(scan, side, by, seam, config); });
  };
  AlongGuide found;
  if (!guide.places.empty()) found = look_along(guide);
  if (found.decision.paths.empty()) {
    const std::optional<Refusal> no_guide = found.decision.refusal;
    found.decision = clock.run("decision", [&] {
      return decide(layers, plan_shape(side_reach(side)), seam, config.min_confidence_ratio);
    });
    // The course leaves its crease somewhere, and the way on it cannot be followed.
    if (no_guide && !found.decision.refusal) {
      found.decision.refusal = no_guide;
      found.decision.for_review = true;
    }
    if (!found.decision.refusal || found.decision.for_review) {
      found.placed = clock.run("place", [&] {
        return place_path(scan, side, found.decision.paths.front().row,
                          {.hold = layers.hold, .other_mm = layers.other_mm, .sharp = layers.sharp},
                          config.point_spacing_mm);
      });
    }
  }
  const auto written = [&](const AlongGuide& line) {
    return clock.run("finish", [&] {
      uncertainty::WholeScan whole{.head = {}, .arm = scan.arm};
      if (config.head != nullptr && !scan.poses.empty()) whole.head.emplace(*config.head, scan.poses);
      return finish(side, line.decision, line.placed, config, whole);
    });
  };
  Extraction extraction = written(found);
  if (extraction.refusal &&
      (changes_crease(layers, *extraction.refusal) || climbs_steeply(side.field.grid, layers))) {
    const Guide round = clock.run("way_round", [&] { return way_round(side, layers, {}); });
    if (!round.places.empty()) {
      AlongGuide along = look_along(round);
      if (Extraction again = written(along); again.verdict() > extraction.verdict()) {
        found = std::move(along);
        extraction = std::move(again);
      }
    }
  }
  extraction.seam = seam;
  extraction.stages = clock.take();
  if (workings != nullptr)
    workings->emplace(Workings{std::move(side), std::move(found.decision), std::move(found.placed)});
  return extraction;
}

Extraction find_bite_line(const cloud::PointCloud& cloud, const Config& config,
                          std::optional<Workings>* workings) {
  const PointRuns runs = runs_of(cloud);
  return find_bite_line(runs.scan(cloud.points), config, workings);
}

}  // namespace biteline::bite_line
