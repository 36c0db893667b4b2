// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/find_by_curve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/bite_line/layers/evidence.hpp"
#include "host/bite_line/layers/layers.hpp"
#include "host/bite_line/level/levelled.hpp"
#include "host/bite_line/level/place_along.hpp"
#include "host/bite_line/path/creases.hpp"
#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/place/finish.hpp"
#include "host/bite_line/side/seam.hpp"
#include "host/bite_line/side/side_outline.hpp"

namespace biteline::bite_line {

namespace {

// A high heel's line, and what lies above it.
constexpr double k_top_mm = 150;
// Of the curve's smoothing: its cells have corners.
constexpr double k_curve_sigma_mm = 1.5;

Raster raster_of(const Side& side) {
  const SideGrid& grid = side.field.grid;
  return Raster::of({side.field.places.data(), side.field.places.size()}, side.outline.length_mm(),
                    grid.z_low_mm, grid.rows * grid.row_mm, side.field.points_per_mm2);
}

/// The station beside each column of the levelled side.
std::vector<const CurveStation*> on_columns_of(const std::vector<CurveStation>& stations,
                                               const Levelled& levelled, const SideGrid& grid) {
  std::vector<const CurveStation*> beside(static_cast<std::size_t>(grid.cols), nullptr);
  for (const CurveStation& station : stations) {
    const double col = levelled.u_mm(station.place) / grid.col_mm;
    beside[std::min(static_cast<std::size_t>(col), beside.size() - 1)] = &station;
  }
  const CurveStation* last = &stations.back();
  for (const CurveStation*& station : beside) {
    if (station == nullptr) station = last;
    last = station;
  }
  return beside;
}

/// The curve as the gates and the placing steps take it: a crease along the levelled side's middle.
Layers layers_of(const CurveOnSide& found, const Levelled& levelled, const Side& level) {
  const SideGrid& grid = level.field.grid;
  const double row = (levelled.height_mm() - grid.z_low_mm) / grid.row_mm - 0.5;
  const std::vector<int> path(static_cast<std::size_t>(grid.cols), static_cast<int>(std::lround(row)));
  const Evidence evidence = find_evidence(level.field, {.thin_soles = true});
  Layers layers;
  layers.line = describe(level.field, {evidence.likeness.data(), evidence.likeness.size()}, path, {});
  for (const CurveStation* station : on_columns_of(found.stations, levelled, grid)) {
    layers.hold.push_back(static_cast<float>(station->hold));
    layers.other_mm.push_back(station->alternatives.empty()
                                  ? 0.0F
                                  : static_cast<float>(std::abs(station->alternatives.front().off_mm)));
  }
  layers.sharp = sharp_along(level.field, layers.line);
  return layers;
}

struct PlacedCurve {
  Decision decision;
  PlacedLine placed;
};

PlacedCurve place_curve(const ScanPoints& scan, const Side& side, const CurveOnSide& found,
                        const std::optional<SeamStep>& seam, const Config& config) {
  PlacedCurve result;
  std::vector<Vec2> guide;
  for (const CurveStation& station : found.stations) guide.push_back(station.place);
  const OrRefusal<Levelled> levelled =
      Levelled::along(side, smooth_guide(guide, side.outline.length_mm(), k_curve_sigma_mm));
  if (!levelled) {
    result.decision.refusal = levelled.error();
    return result;
  }
  const Side level = side_along(*levelled);
  const Layers layers = layers_of(found, *levelled, level);
  result.decision = decide(layers, plan_shape(side_reach(side)), seam, config.min_confidence_ratio);
  if (!result.decision.refusal || result.decision.for_review) {
    OrRefusal<PlacedLine> placed = place_along(scan, side,
                                               {.levelled = *levelled,
                                                .grid = level.field.grid,
                                                .path_row = result.decision.paths.front().row,
                                                .layers = layers},
                                               config.point_spacing_mm);
    if (placed) {
      result.placed = std::move(*placed);
    } else {
      result.decision.refusal = placed.error();
      result.decision.for_review = false;
    }
  }
  for (JudgedPath& path : result.decision.paths) path.row = levelled->back(level.field, path.row);
  return result;
}

}  // namespace

std::optional<CurveOnSide> curve_on(const Side& side) {
  const Raster raster = raster_of(side);
  CreaseLooks looks{raster};
  const CurveCosts costs = curve_costs(raster, looks, fitted_weights());
  const CurveSearch search{costs, {}};
  std::optional<ClosedCurve> best = search.best();
  if (!best) return std::nullopt;
  Large<float> excess = search.excess_about(*best);
  std::optional<double> rival_excess;
  if (const std::optional<ClosedCurve> rival = search.other_than(*best)) {
    rival_excess = std::max(0.0, rival->energy - best->energy);
    add_rival(raster, *rival, *rival_excess, excess);
  }
  std::vector<CurveStation> stations = curve_posterior(raster, *best, excess, {});
  return CurveOnSide{
      .curve = std::move(*best), .rival_excess = rival_excess, .stations = std::move(stations)};
}

Extraction find_by_curve(const ScanPoints& scan, const Config& config, std::optional<Workings>* workings) {
  report::StageClock clock;
  OrRefusal<Shoe> shoe = clock.run("shoe", [&] { return find_shoe(scan.means); });
  if (!shoe) return refused(shoe.error(), clock.take());
  Outline outline = clock.run("outline", [&] { return side_outline(*shoe); });
  SideField field = clock.run("side", [&] { return SideField::build(*shoe, outline, {.top_mm = k_top_mm}); });
  Side side{std::move(*shoe), std::move(outline), std::move(field)};
  const std::optional<SeamStep> seam =
      clock.run("seam", [&] { return seam_step(scan, side.shoe, side.outline); });
  const std::optional<CurveOnSide> found = clock.run("curve", [&] { return curve_on(side); });
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

Extraction find_by_curve(const cloud::PointCloud& cloud, const Config& config,
                         std::optional<Workings>* workings) {
  const PointRuns runs = runs_of(cloud);
  return find_by_curve(runs.scan(cloud.points), config, workings);
}

}  // namespace biteline::bite_line
