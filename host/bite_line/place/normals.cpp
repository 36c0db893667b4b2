// SPDX-License-Identifier: MIT
#include "host/bite_line/place/normals.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "host/geometry/bridge.hpp"
#include "host/geometry/closed_spline.hpp"

namespace biteline::bite_line {

namespace {

constexpr double k_strip_mm = 0.25;
/// A stitch and its gap: what a slope at the edge of a hole is averaged over before it is carried across.
constexpr double k_ends_mm = 3.0;
/// Farther from the smooth surface than a stitch or a seam stands out: a stray point.
constexpr double k_stray_mm = 0.8;

/// Values at every station, and where they are known.
struct Track {
  std::vector<double> value;
  std::vector<std::uint8_t> known;
  explicit Track(std::size_t stations) : value(stations, 0.0), known(stations, 0) {}
  void set(std::size_t station, double v) {
    value[station] = v;
    known[station] = 1;
  }
};

struct Strip {
  Track o;
  Track slope_along;
};

double row_of(const Sections& sections, int station, double z_mm) {
  return sections.zero_row + (z_mm - sections.path_z_mm[static_cast<std::size_t>(station)]) / sections.row_mm;
}

/// The smooth surface at a row, and its slope up; nothing where it is not known.
struct Smooth {
  double o_mm;
  double slope;
};
std::optional<Smooth> smooth_at(const Sections& sections, int station, double row) {
  const int middle = static_cast<int>(std::lround(row));
  constexpr int k_reach = 3;
  if (middle - k_reach < 0 || middle + k_reach >= sections.rows) return std::nullopt;
  const std::size_t low = sections.at(station, middle - k_reach);
  const std::size_t here = sections.at(station, middle);
  const std::size_t high = sections.at(station, middle + k_reach);
  if (sections.known[low] == 0 || sections.known[here] == 0 || sections.known[high] == 0) return std::nullopt;
  return Smooth{.o_mm = static_cast<double>(sections.o_mm[here]),
                .slope = static_cast<double>(sections.o_mm[high] - sections.o_mm[low]) /
                         (2 * k_reach * sections.row_mm)};
}

/// What one strip's points say at one station.
struct Weighted {
  geometry::ClosedSpline::Knot knot;
  double points;  ///< 0: none there
};

/// All strips of a station, whose points lie beside each other in memory.
void read_station(const NormalInput& input, int station, double from_mm, std::span<Weighted> strips) {
  const Sections& sections = input.sections;
  const double turn_mm = sections.stations * sections.station_mm;
  const double rows = k_strip_mm / sections.row_mm;
  for (std::size_t k = 0; k < strips.size(); ++k) {
    strips[k].points = 0;
    const double above_line_mm = from_mm + static_cast<double>(k) * k_strip_mm;
    const double z = input.line_z_mm[static_cast<std::size_t>(station)] + above_line_mm;
    const double low = row_of(sections, station, z);
    const auto first = static_cast<int>(std::lround(low));
    const SectionPoints::Patch patch =
        input.points.patch(station, first, first + static_cast<int>(std::lround(rows)));
    if (patch.points == 0) continue;
    const double middle = low + 0.5 * rows - 0.5;
    const std::optional<Smooth> smooth = smooth_at(sections, station, middle);
    if (!smooth) continue;
    // A strip's few points do not lie round its middle: brought there along the surface.
    const double o = patch.o_mm + smooth->slope * (middle - patch.row) * sections.row_mm;
    if (std::abs(o - smooth->o_mm) > k_stray_mm) continue;
    const double at = station * sections.station_mm + patch.s_mm;
    strips[k] = {{at < 0 ? at + turn_mm : at, o}, patch.points};
  }
}

/// What one strip's points say, by place along the line; those of one profile that fall on two stations are
/// joined.  `read`: of its stations in their order.
std::vector<geometry::ClosedSpline::Knot> knots_of(std::vector<Weighted> found, double turn_mm) {
  std::erase_if(found, [](const Weighted& weighted) { return weighted.points == 0; });
  const auto before = [](const Weighted& a, const Weighted& b) { return a.knot.at_mm < b.knot.at_mm; };
  // The first station's may lie at the end of the turn.
  if (found.size() > 1 && before(found.back(), found.front()))
    std::rotate(found.begin(), found.begin() + 1, found.end());
  if (!std::is_sorted(found.begin(), found.end(), before)) std::sort(found.begin(), found.end(), before);
  const double usual_mm = turn_mm / static_cast<double>(std::max<std::size_t>(found.size(), 1));
  std::vector<geometry::ClosedSpline::Knot> knots;
  double points = 0;
  for (const Weighted& next : found) {
    if (!knots.empty() && next.knot.at_mm - knots.back().at_mm < 0.5 * usual_mm) {
      const double share = next.points / (points + next.points);
      knots.back().at_mm += share * (next.knot.at_mm - knots.back().at_mm);
      knots.back().value += share * (next.knot.value - knots.back().value);
      points += next.points;
      continue;
    }
    knots.push_back(next.knot);
    points = next.points;
  }
  if (knots.size() > 1 && knots.front().at_mm + turn_mm - knots.back().at_mm < 0.5 * usual_mm)
    knots.pop_back();
  return knots;
}

Strip strip_of(const Sections& sections, std::vector<Weighted> found) {
  constexpr double k_longest_mm = 3.0;     // between profiles that belong together; more is a hole
  constexpr double k_longest_usual = 3.0;  // the same in sparse clouds
  const auto stations = static_cast<std::size_t>(sections.stations);
  const double turn_mm = sections.stations * sections.station_mm;
  Strip strip{Track{stations}, Track{stations}};
  std::vector<geometry::ClosedSpline::Knot> knots = knots_of(std::move(found), turn_mm);
  if (knots.size() < 8) return strip;
  const double longest =
      std::max(k_longest_mm, k_longest_usual * turn_mm / static_cast<double>(knots.size()));
  const geometry::ClosedSpline spline{std::move(knots), turn_mm};
  const auto samples = spline.every(sections.station_mm, stations);
  for (std::size_t i = 0; i < stations; ++i) {
    const geometry::ClosedSpline::Sample& sample = samples[i];
    if (sample.interval_mm > longest) continue;
    strip.o.set(i, sample.value);
    strip.slope_along.set(i, sample.slope);
  }
  return strip;
}

/// How fast the line itself moves outwards, over a few millimetres.
std::vector<double> slopes_of_line(const NormalInput& input) {
  constexpr double k_reach_mm = 2.0;
  const std::size_t stations = input.line_plan.size();
  const double station_mm = input.sections.station_mm;
  std::vector<double> o(stations);
  for (std::size_t i = 0; i < stations; ++i) {
    const double s = static_cast<double>(i) * station_mm;
    o[i] = (input.line_plan[i] - input.outline.point(s)).dot(input.outline.normal(s));
  }
  const auto reach = static_cast<std::size_t>(std::max(1.0, std::round(k_reach_mm / station_mm)));
  std::vector<double> slope(stations);
  for (std::size_t i = 0; i < stations; ++i)
    slope[i] = (o[(i + reach) % stations] - o[(i + stations - reach) % stations]) /
               (2 * static_cast<double>(reach) * station_mm);
  return slope;
}

bool seen(const Track& track) {
  return std::find(track.known.begin(), track.known.end(), 1) != track.known.end();
}

/// Mean over the tracks that were seen anywhere, gaps bridged.
std::vector<double> mean_of(std::vector<Track>& tracks, std::size_t stations, double station_mm) {
  std::vector<double> mean(stations, 0.0);
  double count = 0;
  for (Track& track : tracks) {
    if (!seen(track)) continue;
    geometry::bridge_means(track.value, track.known, station_mm, k_ends_mm);
    for (std::size_t i = 0; i < stations; ++i) mean[i] += track.value[i];
    count += 1;
  }
  for (double& value : mean) value /= std::max(count, 1.0);
  return mean;
}

}  // namespace

std::vector<Vec3> normals_above(const NormalInput& input, const NormalConfig& config) {
  const Sections& sections = input.sections;
  const auto stations = static_cast<std::size_t>(sections.stations);
  const auto count = static_cast<std::size_t>(std::lround((config.to_mm - config.from_mm) / k_strip_mm));
  std::vector<std::vector<Weighted>> read(count, std::vector<Weighted>(stations));
  tbb::parallel_for(tbb::blocked_range<int>{0, sections.stations, 64}, [&](const auto& range) {
    std::vector<Weighted> of_station(count);
    for (int station = range.begin(); station != range.end(); ++station) {
      read_station(input, station, config.from_mm, of_station);
      for (std::size_t k = 0; k < count; ++k) read[k][static_cast<std::size_t>(station)] = of_station[k];
    }
  });
  std::vector<Strip> strips(count, Strip{Track{0}, Track{0}});
  tbb::parallel_for(std::size_t{0}, count,
                    [&](std::size_t k) { strips[k] = strip_of(sections, std::move(read[k])); });
  std::vector<Track> o, up, along;
  for (std::size_t k = 0; k < count; ++k) {
    if (k > 0) {
      Track slope{stations};
      const Track& low = strips[k - 1].o;
      const Track& high = strips[k].o;
      for (std::size_t i = 0; i < stations; ++i) {
        if (low.known[i] != 0 && high.known[i] != 0)
          slope.set(i, (high.value[i] - low.value[i]) / k_strip_mm);
      }
      up.push_back(std::move(slope));
    }
    o.push_back(strips[k].o);
    along.push_back(std::move(strips[k].slope_along));
  }
  const std::vector<double> line_slope = slopes_of_line(input);
  for (Track& track : along) {
    for (std::size_t i = 0; i < stations; ++i) track.value[i] -= line_slope[i];
  }
  const std::vector<double> mean_o = mean_of(o, stations, sections.station_mm);
  const std::vector<double> slope_up = mean_of(up, stations, sections.station_mm);
  const std::vector<double> slope_strip = mean_of(along, stations, sections.station_mm);

  std::vector<Vec3> normals(stations);
  for (std::size_t i = 0; i < stations; ++i) {
    const double s = static_cast<double>(i) * sections.station_mm;
    const Vec2 out = input.outline.normal(s);
    // The strips climb with the line; what they climb is not a slope along it.
    const double climb =
        (input.line_z_mm[(i + 1) % stations] - input.line_z_mm[(i + stations - 1) % stations]) /
        (2 * sections.station_mm);
    // At o outside the outline a step along it is (1 + bend o) as long.
    const double stretch = std::max(0.3, 1.0 + input.outline.bend_per_mm(s) * mean_o[i]);
    const double slope_along = (slope_strip[i] + line_slope[i] - slope_up[i] * climb) / stretch;
    Vec3 normal{0, 0, -slope_up[i]};
    normal.head<2>() = out - slope_along * Vec2{-out.y(), out.x()};
    normals[i] = normal.normalized();
  }
  return normals;
}

}  // namespace biteline::bite_line
