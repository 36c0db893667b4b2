// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_look.hpp"

#include <algorithm>
#include <cmath>

#include "host/geometry/robust.hpp"

namespace biteline::bite_line {

namespace {

double value_of(const SeenPlace& place, CreaseSign sign) {
  return static_cast<double>(place.signs[static_cast<std::size_t>(sign)]);
}

/// Sums over the places before each: of what is known of them, and of their lengths.
struct Sums {
  double mm{0}, seen_mm{0}, cost{0}, rim{0}, below{0};
};

/// Thrice round.
std::vector<Sums> sums_along(const PlacesAlong& places) {
  std::vector<Sums> sums{{}};
  for (std::size_t i = 0; i < 3 * places.size(); ++i) {
    Sums next = sums.back();
    const std::optional<SeenPlace>& place = places[i % places.size()];
    const double mm = place ? place->mm : Raster::k_cell_mm;
    next.mm += mm;
    if (place) {
      next.seen_mm += mm;
      next.cost += mm * place->per_mm;
      next.rim += mm * value_of(*place, CreaseSign::RimRight);
      next.below += mm * value_of(*place, CreaseSign::RightCrease);
    }
    sums.push_back(next);
  }
  return sums;
}

}  // namespace

PlacesAlong places_along(const CurveGround& ground, std::span<const CurveState> states) {
  PlacesAlong places;
  for (const CurveState& at : states) {
    const int col = ground.raster.round_col(at.col);
    const std::size_t cell = ground.raster.at(at.row, col);
    std::optional<SeenPlace>& place = places.emplace_back();
    if (ground.raster.seen[cell] != 0)
      place = SeenPlace{.signs = ground.looks.all(at.row, col, at.direction),
                        .per_mm = static_cast<double>(ground.costs.of(cell, at.direction)),
                        .mm = k_cell_steps[at.direction].length() * Raster::k_cell_mm};
  }
  return places;
}

std::vector<SeenPlace> seen_of(const PlacesAlong& places, std::size_t first, std::size_t count) {
  std::vector<SeenPlace> seen;
  for (std::size_t i = first; i < first + count; ++i)
    if (const std::optional<SeenPlace>& place = places[i % places.size()]) seen.push_back(*place);
  return seen;
}

double mean_of(std::span<const SeenPlace> places, CreaseSign sign) {
  double sum = 0;
  for (const SeenPlace& place : places) sum += value_of(place, sign);
  return sum / static_cast<double>(std::max<std::size_t>(places.size(), 1));
}

double mean_per_mm(std::span<const SeenPlace> places) {
  double sum = 0;
  for (const SeenPlace& place : places) sum += place.per_mm;
  return sum / static_cast<double>(std::max<std::size_t>(places.size(), 1));
}

double uneven_along(std::span<const SeenPlace> places) {
  constexpr std::size_t k_run = 17;
  if (places.size() < k_run) return 0;
  const double mean = mean_per_mm(places);
  double squares = 0;
  for (std::size_t i = 0; i + k_run <= places.size(); ++i) {
    const double off = mean_per_mm(places.subspan(i, k_run)) - mean;
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(places.size() - k_run + 1));
}

double faintest_of(std::span<const SeenPlace> places) {
  constexpr double k_run_mm = 3;
  double most = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    double cost = 0, mm = 0;
    for (std::size_t j = i; j < places.size() && mm < k_run_mm; ++j) {
      cost += places[j].per_mm * places[j].mm;
      mm += places[j].mm;
    }
    if (mm >= k_run_mm || i == 0) most = std::max(most, cost / mm);
  }
  return most;
}

CurveLook look_of(const PlacesAlong& closed) {
  constexpr double k_about_mm = 10;
  const std::size_t n = closed.size();
  const std::vector<Sums> sums = sums_along(closed);
  CurveLook look{.per_mm = sums.back().cost / std::max(sums.back().seen_mm, Raster::k_cell_mm), .places = {}};
  std::vector<PlaceLook>& looks = look.places;
  looks.resize(n);
  std::vector<double> rims, belows;
  std::size_t first = 0, end = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double mm = sums[n + i].mm;
    while (sums[first + 1].mm < mm - k_about_mm) ++first;
    while (end + 1 < sums.size() && sums[end].mm < mm + k_about_mm) ++end;
    const double seen_mm = sums[end].seen_mm - sums[first].seen_mm;
    if (!(seen_mm > 0)) continue;
    looks[i] = {.seen = true,
                .per_mm = (sums[end].cost - sums[first].cost) / seen_mm,
                .rim = (sums[end].rim - sums[first].rim) / seen_mm,
                .unlike_below = (sums[end].below - sums[first].below) / seen_mm};
    rims.push_back(looks[i].rim);
    belows.push_back(looks[i].unlike_below);
  }
  if (rims.empty()) return look;
  const double rim = geometry::median_of(std::move(rims)), below = geometry::median_of(std::move(belows));
  for (PlaceLook& place : looks) {
    place.unlike_rim = std::abs(place.rim - rim);
    place.unlike_below = std::abs(place.unlike_below - below);
  }
  return look;
}

}  // namespace biteline::bite_line
