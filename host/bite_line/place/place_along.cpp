// SPDX-License-Identifier: MIT
#include "host/bite_line/place/place_along.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "host/bite_line/place/gap_bridge.hpp"
#include "host/bite_line/place/place_path.hpp"
#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

/// (u, z) of a path, smoothed: its rows are whole ones.
std::vector<Vec2> places_of(const SideGrid& grid, std::span<const double> path_row) {
  constexpr double k_sigma_mm = 1.5;
  const std::vector<double> row = geometry::smooth_closed(path_row, k_sigma_mm / grid.col_mm);
  std::vector<Vec2> places;
  for (std::size_t c = 0; c < row.size(); ++c)
    places.emplace_back((static_cast<double>(c) + 0.5) * grid.col_mm, grid.z_mm(row[c]));
  return places;
}

/// (u, z) of the sections' own places: the running mean along the line cuts corners, too.
std::vector<Vec2> places_of(const Straightened& straightened, const PlacedLine& placed) {
  constexpr double k_sigma_mm = 0.8;
  const double turn_mm = straightened.outline().length_mm();
  std::vector<double> z_mm;
  for (const PlacedStation& station : placed.points) z_mm.push_back(station.own_z_mm);
  z_mm = geometry::smooth_closed(z_mm, k_sigma_mm * static_cast<double>(z_mm.size()) / placed.length_mm);
  std::vector<Vec2> places;
  for (std::size_t i = 0; i < z_mm.size(); ++i) {
    auto u_mm =
        static_cast<double>(straightened.outline().locate(placed.points[i].position.cast<float>()).s_mm);
    // The first one lies beside the outline's begin, and may lie just before it.
    u_mm -= turn_mm * std::round((u_mm - (i > 0 ? places.back().x() : 0.0)) / turn_mm);
    places.emplace_back(u_mm, z_mm[i]);
  }
  return places;
}

/// A guide that follows a line which was placed, and what that does not know of it.
struct LineGuide {
  std::vector<Vec2> places;
  /// Standard deviation where it is carried across a gap; empty elsewhere.
  std::vector<std::optional<double>> carried_off_mm;
};

/// Both ends point at each other: a bridge that turned back would fold the side.
bool runs_forwards(const PlanBridge& bridge) {
  const Vec3 chord = bridge.one.p1 - bridge.one.p0;
  return bridge.one.d0.dot(chord) > 0 && bridge.one.d1.dot(chord) > 0;
}

/// A guide is led by what is beside the crease, too: over what stands in front of it, along the sole's edge.
/// Where the crease was not seen the guide is carried across, as the line's plan is.  `places`: a guide of
/// the shoe, one for each station of `placed`.
LineGuide carried_across(std::vector<Vec2> places, const PlacedLine& placed, double turn_mm) {
  const std::size_t count = places.size();
  const double station_mm = placed.length_mm / static_cast<double>(count);
  std::vector<std::uint8_t> known;
  for (const PlacedStation& station : placed.points) known.push_back(station.to_visible_mm > 0 ? 0 : 1);
  // A turn more at either end: there is no end then.
  std::vector<Vec2> turns;
  for (const double turn : {-1.0, 0.0, 1.0}) {
    for (const Vec2& place : places) turns.push_back(place + Vec2{turn * turn_mm, 0});
  }
  const std::vector<std::uint8_t> nearly_known = known_but_for_short(known, station_mm);
  std::vector<std::uint8_t> known_turns;
  for (int turn = 0; turn < 3; ++turn)
    known_turns.insert(known_turns.end(), nearly_known.begin(), nearly_known.end());
  LineGuide guide{.places = std::move(places), .carried_off_mm = {}};
  guide.carried_off_mm.resize(count);
  for (const geometry::Gap& gap : geometry::gaps_of(nearly_known)) {
    const geometry::Gap in_turns{.first = count + gap.first, .steps = gap.steps};
    const std::optional<PlanBridge> bridge = firm_bridge(turns, known_turns, in_turns, station_mm);
    if (!bridge || !runs_forwards(*bridge)) continue;
    for (std::size_t k = 1; k < gap.steps; ++k) {
      const std::size_t at = (gap.first + k) % count;
      const double share = static_cast<double>(k) / static_cast<double>(gap.steps);
      guide.places[at] = bridge->at(share) - Vec2{gap.first + k < count ? 0.0 : turn_mm, 0};
      guide.carried_off_mm[at] = bridge->off_mm(share);
    }
  }
  return guide;
}

/// The values of the columns beside which another straightened side's columns lie.
std::vector<float> on_columns(std::span<const float> values, const FoundLevel& of, const Straightened& to,
                              const SideGrid& to_grid) {
  std::vector<float> on;
  for (int c = 0; c < to_grid.cols; ++c) {
    const double u_mm = of.straightened.u_mm(to.place((c + 0.5) * to_grid.col_mm));
    on.push_back(values[std::min(static_cast<std::size_t>(u_mm / of.grid.col_mm), values.size() - 1)]);
  }
  return on;
}

/// On the straightened side, whose guide is the path.
PlacedLine place_on(const ScanPoints& scan, const Straightened& straightened, const FoundLevel& found,
                    double spacing_mm) {
  // A steeper climb would leave of the definition's Gaussian less than a few points are apart.
  constexpr double k_least_ratio = 0.5;
  const Side level = side_along(straightened);
  const SideGrid& grid = level.field.grid;
  const std::vector<double> row(static_cast<std::size_t>(grid.cols),
                                (straightened.height_mm() - grid.z_low_mm) / grid.row_mm - 0.5);
  const auto here = [&](std::span<const float> values) {
    return on_columns(values, found, straightened, grid);
  };
  const std::vector<float> hold = here(found.layers.hold);
  const std::vector<float> other_mm = here(found.layers.other_mm);
  const std::vector<float> sharp = here(found.layers.sharp);
  std::vector<float> upright_ratio;
  for (int c = 0; c < grid.cols; ++c) {
    upright_ratio.push_back(
        static_cast<float>(std::max(straightened.upright_ratio((c + 0.5) * grid.col_mm), k_least_ratio)));
  }
  const PooledVector<Eigen::Vector3f> points = straightened.points(scan.points);
  ScanPoints on_level = scan;
  on_level.points = points;
  return place_path(on_level, level, row,
                    {.hold = hold, .other_mm = other_mm, .sharp = sharp, .upright_ratio = upright_ratio},
                    spacing_mm);
}

/// What the definition's own line may be off a straightened one.  Its running mean cuts bends: by half the
/// bend times the mean's variance, of which nothing is left here; that is taken for two standard deviations.
/// Its upright section sees the flanks of a crease that climbs at another angle: 0.05 mm where made pumps
/// climb by 40 degrees.  What was not seen follows the guide: `found`, whose corners its own smoothing cuts,
/// too, or `line` where that was carried across.
void doubt_place(const Straightened& straightened, const Straightened& found, const LineGuide& line,
                 PlacedLine& placed) {
  constexpr double k_mean_mm = PlacementConfig{}.mean_mm;
  constexpr double k_mean_mm2 = k_mean_mm * k_mean_mm / 12;
  constexpr double k_square_mm = 0.04;  // standard deviation, of an upright line
  std::vector<double> u_mm, bend2_per_mm2;
  for (const PlacedStation& station : placed.points) {
    u_mm.push_back(static_cast<double>(straightened.outline().locate(station.position.cast<float>()).s_mm));
    bend2_per_mm2.push_back(std::pow(straightened.bend_per_mm(u_mm.back()), 2));
  }
  // What is read beside a corner takes the corner in: there the bend's RMS counts twice.
  const std::vector<double> about =
      geometry::running_mean(bend2_per_mm2, k_mean_mm * static_cast<double>(u_mm.size()) / placed.length_mm);
  for (std::size_t i = 0; i < u_mm.size(); ++i) {
    PlacedStation& station = placed.points[i];
    const double bend_per_mm = std::sqrt(std::max(bend2_per_mm2[i], 4 * about[i]));
    const double mean_cuts_mm = bend_per_mm * k_mean_mm2 / 2;
    const double ratio = straightened.upright_ratio(u_mm[i]);
    const double square_mm = k_square_mm * std::sqrt(1 - ratio * ratio);
    double guide_off_mm = 0;
    if (station.to_visible_mm > 0) {
      const Vec2 place = straightened.place(u_mm[i]);
      const double found_bend_per_mm = std::abs(found.bend_per_mm(found.u_mm(place)));
      // The line's guide has a place for each of its stations, and begins where the line does.
      guide_off_mm = line.carried_off_mm[i * line.places.size() / u_mm.size()].value_or(
          found_bend_per_mm * (k_guide_sigma_mm * k_guide_sigma_mm + k_mean_mm2) / 2);
    }
    station.between_up_mm =
        std::hypot(std::hypot(station.between_up_mm, mean_cuts_mm / 2, square_mm), guide_off_mm);
  }
}

/// A straightened line runs level, and so bridges that are tried on it are never off.  On the shoe they are.
/// Where it climbs upright none is tried: one corner would speak for all gaps.
void try_bridges(PlacedLine& placed) {
  constexpr double k_upright = 0.5;  // sine of 30 degrees
  const std::size_t count = placed.points.size();
  const double station_mm = placed.length_mm / static_cast<double>(count);
  std::vector<double> z_mm;
  std::vector<std::uint8_t> known, usual;
  for (std::size_t i = 0; i < count; ++i) {
    const double climb_mm =
        placed.points[(i + 1) % count].position.z() - placed.points[(i + count - 1) % count].position.z();
    z_mm.push_back(placed.points[i].position.z());
    known.push_back(placed.points[i].to_visible_mm > 0 ? 0 : 1);
    usual.push_back(known.back() != 0 && std::abs(climb_mm) < k_upright * 2 * station_mm ? 1 : 0);
  }
  const std::vector<double> tried_mm = tried_heights(z_mm, known, usual, station_mm);
  for (std::size_t i = 0; i < count; ++i) {
    PlacedStation& station = placed.points[i];
    station.tried_up_mm = std::hypot(station.tried_up_mm, tried_mm[i]);
  }
}

}  // namespace

void doubt_guide_in_gaps(double guide_z_mm, PlacedLine& placed) {
  const std::size_t count = placed.points.size();
  std::vector<std::uint8_t> known;
  for (const PlacedStation& station : placed.points) known.push_back(station.to_visible_mm > 0 ? 0 : 1);
  for (const geometry::Gap& gap : geometry::gaps_of(known)) {
    const auto off_mm = [&](std::size_t steps) {
      return placed.points[(gap.first + steps) % count].own_z_mm - guide_z_mm;
    };
    for (std::size_t k = 1; k < gap.steps; ++k) {
      PlacedStation& station = placed.points[(gap.first + k) % count];
      const double share = static_cast<double>(k) / static_cast<double>(gap.steps);
      station.between_up_mm =
          std::hypot(station.between_up_mm, (1 - share) * off_mm(0), share * off_mm(gap.steps));
    }
  }
}

Side side_along(const Straightened& straightened) {
  Shoe shoe = straightened.shoe();
  SideField field = SideField::build(shoe, straightened.outline(), {});
  return {std::move(shoe), straightened.outline(), std::move(field)};
}

OrRefusal<PlacedLine> place_along(const ScanPoints& scan, const Side& side, const FoundLevel& found,
                                  double spacing_mm) {
  constexpr double k_spaced_mm = 0.5;
  const double turn_mm = side.outline.length_mm();
  const auto along = [&](std::span<const Vec2> places) {
    return Straightened::along(side, smooth_guide(places, turn_mm, k_spaced_mm), k_placed_beside_mm);
  };
  const OrRefusal<Straightened> first =
      along(found.straightened.guide(places_of(found.grid, found.path_row)));
  if (!first) return tl::unexpected{first.error()};
  const PlacedLine nearly = place_on(scan, *first, found, spacing_mm);
  const LineGuide line = carried_across(first->guide(places_of(*first, nearly)), nearly, turn_mm);
  const OrRefusal<Straightened> second = along(line.places);
  if (!second) return tl::unexpected{second.error()};
  PlacedLine placed = place_on(scan, *second, found, spacing_mm);
  doubt_place(*second, found.straightened, line, placed);
  doubt_guide_in_gaps(second->height_mm(), placed);
  placed = second->back(std::move(placed));
  try_bridges(placed);
  return placed;
}

}  // namespace biteline::bite_line
