// SPDX-License-Identifier: MIT
#include "host/bite_line/find_bite_line.hpp"

#include <utility>

#include "host/bite_line/curve/curve_on_side.hpp"
#include "host/bite_line/curve/place_curve.hpp"
#include "host/bite_line/place/finish.hpp"
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
  const std::optional<SeamStep> seam =
      clock.run("seam", [&] { return seam_step(scan, side.shoe, side.outline); });
  const std::optional<CurveOnSide> found = clock.run("curve", [&] { return curve_on(side, scan.looks); });
  if (!found) return refused({Refused::NoCreaseAllRound, "no curve leads round the side"}, clock.take());
  PlacedCurve placed = clock.run("place", [&] { return place_curve(scan, side, *found, seam, config); });
  Extraction extraction = clock.run("finish", [&] {
    uncertainty::WholeScan whole{.head = {}, .arm = scan.arm};
    if (config.head != nullptr && !scan.poses.empty()) whole.head.emplace(*config.head, scan.poses);
    return finish(side, placed.decision, placed.placed, config, whole);
  });
  extraction.seam = seam;
  extraction.stages = clock.take();
  if (workings != nullptr)
    workings->emplace(Workings{std::move(side), std::move(placed.decision), std::move(placed.placed)});
  return extraction;
}

Extraction find_bite_line(const cloud::PointCloud& cloud, const Config& config,
                          std::optional<Workings>* workings) {
  const PointRuns runs = runs_of(cloud);
  return find_bite_line(runs.scan(cloud.points), config, workings);
}

}  // namespace biteline::bite_line
