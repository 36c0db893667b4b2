// SPDX-License-Identifier: MIT
#include "host/bite_line/place/placement.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_invoke.h>

#include "host/bite_line/buckets.hpp"
#include "host/bite_line/place/bare_doubt.hpp"
#include "host/bite_line/place/gap_bridge.hpp"
#include "host/bite_line/place/ridge_doubt.hpp"
#include "host/bite_line/place/sampling.hpp"
#include "host/bite_line/place/section_course.hpp"
#include "host/bite_line/place/thing_beside.hpp"
#include "host/bite_line/side/outer_layer.hpp"
#include "host/geometry/bridge.hpp"
#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

/// From the path: what may be a hollow's bottom is the line's own there.
constexpr float k_hollow_reach_mm = 1.25F;

/// Per station: how far the nearest known one is, and what to think of a place in between.
struct GapPlace {
  double to_known_mm{0};
  double doubt{0};
  double most_doubt{0};  ///< that of the gap's middle
  bool in_long{false};
};

std::vector<GapPlace> gap_places(std::span<const std::uint8_t> known, const Outline& outline,
                                 double station_mm) {
  std::vector<GapPlace> places(known.size());
  const std::vector<geometry::Gap> gaps = geometry::gaps_of(known);
  if (gaps.empty() && (known.empty() || known.front() == 0))
    std::fill(places.begin(), places.end(),
              GapPlace{.to_known_mm = 1e9, .doubt = 1e9, .most_doubt = 1e9, .in_long = true});
  for (const geometry::Gap& gap : gaps) {
    const double length_mm = static_cast<double>(gap.steps) * station_mm;
    const double from_mm = static_cast<double>(gap.first) * station_mm;
    const double turn_rad =
        std::acos(std::clamp(outline.normal(from_mm).dot(outline.normal(from_mm + length_mm)), -1.0, 1.0));
    for (std::size_t k = 1; k < gap.steps; ++k) {
      const double to_known_mm = static_cast<double>(std::min(k, gap.steps - k)) * station_mm;
      places[(gap.first + k) % places.size()] = {.to_known_mm = to_known_mm,
                                                 .doubt = gap_doubt(to_known_mm, length_mm, turn_rad),
                                                 .most_doubt = gap_doubt(length_mm / 2, length_mm, turn_rad),
                                                 .in_long = is_long(gap, station_mm)};
    }
  }
  return places;
}

struct Plan {
  std::vector<Vec2> places;
  std::vector<double> corner_mm;  ///< how far another course could lie out or in, see PlacedStation
  std::vector<double> tried_mm;   ///< what such a bridge is off by on this line, at that place; 0 where known
  std::vector<double> off_mm;     ///< how far off it may be as its own ends tell
};

double beyond_chord_mm(const Vec2& from, const Vec2& chord, const Vec2& place) {
  const Vec2 to = place - from;
  return std::abs(to.x() * chord.y() - to.y() * chord.x()) / std::max(chord.norm(), 1e-9);
}

/// o along the outline's normal where the section is known; elsewhere on arcs that leave both ends in their
/// own directions.
Plan plan_of(const Outline& outline, std::span<const double> o, std::span<const std::uint8_t> known,
             double station_mm) {
  const std::size_t count = o.size();
  const std::vector<double> none(count, 0.0);
  Plan made{.places = std::vector<Vec2>(count), .corner_mm = none, .tried_mm = none, .off_mm = none};
  std::vector<Vec2>& plan = made.places;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = static_cast<double>(i) * station_mm;
    plan[i] = outline.point(s) + o[i] * outline.normal(s);
  }
  const std::vector<Vec2> seen = plan;
  const std::vector<std::uint8_t> nearly_known = known_but_for_short(known, station_mm);
  for (const geometry::Gap& gap : geometry::gaps_of(known)) {
    const std::size_t end = (gap.first + gap.steps) % count;
    const PlanBridge bridge = plan_bridge(seen, nearly_known, gap, outline, station_mm);
    const Vec2 chord = seen[end] - seen[gap.first];
    const double turn_rad = bridge.turn_rad();
    const auto corner_mm = [&](double share) {
      if (bridge.firm) return geometry::corner_beyond_arc_mm(chord.norm(), turn_rad) * gap_swell(share);
      // Of an end that is not firm no direction is known: the line may leave the chord at once.
      return geometry::corner_beyond_chord_mm(chord.norm(), turn_rad) * 2 * std::min(share, 1 - share);
    };
    const TriedBridge tried =
        is_long(gap, station_mm) ? tried_plan(seen, known, gap, station_mm) : TriedBridge{};
    for (std::size_t k = 1; k < gap.steps; ++k) {
      const std::size_t at = (gap.first + k) % count;
      const double share = static_cast<double>(k) / static_cast<double>(gap.steps);
      plan[at] = bridge.at(share);
      made.corner_mm[at] = std::max(corner_mm(share), beyond_chord_mm(seen[gap.first], chord, plan[at]));
      made.tried_mm[at] = tried.at(share);
      made.off_mm[at] = bridge.off_mm(share);
    }
  }
  return made;
}

/// What the layers say of the columns that the stations lie in.
void set_layers(const PlacementInput& input, std::vector<PlacedStation>& stations) {
  if (input.hold.empty()) return;
  std::vector<Eigen::Vector3f> positions;
  positions.reserve(stations.size());
  for (const PlacedStation& station : stations) positions.emplace_back(station.position.cast<float>());
  std::vector<OutlinePlace> places(stations.size());
  input.outline.locate(positions, places);
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (places[i].s_mm < 0) {
      stations[i].hold = 0;
      continue;
    }
    const auto col =
        std::min(static_cast<std::size_t>(static_cast<double>(places[i].s_mm) / input.field.grid.col_mm),
                 input.hold.size() - 1);
    stations[i].hold = static_cast<double>(input.hold[col]);
    stations[i].other_mm = static_cast<double>(input.other_mm[col]);
    stations[i].sharp = static_cast<double>(input.sharp[col]);
  }
}

/// Of the stations, from that of the columns.
std::vector<double> upright_ratio_of(const PlacementInput& input, double station_mm) {
  std::vector<double> of_station;
  if (input.upright_ratio.empty()) return of_station;
  for (std::size_t i = 0; i < input.path.z_mm.size(); ++i) {
    const Vec2 at = input.path.outline.point(static_cast<double>(i) * station_mm);
    const OutlinePlace place =
        input.outline.locate(Eigen::Vector3f{static_cast<float>(at.x()), static_cast<float>(at.y()), 0.0F});
    const auto col =
        static_cast<std::size_t>(std::max(place.s_mm, 0.0F) / static_cast<float>(input.field.grid.col_mm));
    of_station.push_back(
        static_cast<double>(input.upright_ratio[std::min(col, input.upright_ratio.size() - 1)]));
  }
  return of_station;
}

/// Of the own heights about the line's, over the running mean's length; what is bridged has none.  Where of a
/// stretch a share s was seen, its sections' RMS is 1 / sqrt(s) times that of all, and the mean leans on so
/// many fewer of them, which is as much again.  Long gaps have doubts of their own, and do not count.
std::vector<double> scatter_of(const std::vector<double>& own_z_mm, const std::vector<double>& z_mm,
                               const std::vector<std::uint8_t>& visible, double mean_mm, double station_mm) {
  const double steps = mean_mm / station_mm;
  std::vector<double> square(z_mm.size());
  for (std::size_t i = 0; i < square.size(); ++i)
    square[i] = visible[i] != 0 ? (own_z_mm[i] - z_mm[i]) * (own_z_mm[i] - z_mm[i]) : 0.0;
  const auto share_of = [&](const std::vector<std::uint8_t>& flags) {
    return geometry::running_mean(std::vector<double>{flags.begin(), flags.end()}, steps);
  };
  std::vector<double> scatter = geometry::running_mean(square, steps);
  const std::vector<double> seen = share_of(visible);
  const std::vector<double> but_for_short = share_of(known_but_for_short(visible, station_mm));
  for (std::size_t i = 0; i < scatter.size(); ++i)
    scatter[i] = std::sqrt(std::max(scatter[i], 0.0)) * but_for_short[i] / std::max(seen[i], 1 / steps);
  return scatter;
}

}  // namespace

double gap_doubt(double to_known_mm, double length_mm, double turn_rad) {
  return to_known_mm / 60.0 * (0.8 + turn_rad) * std::pow(length_mm / 20.0, 1.5);
}

PooledVector<std::uint32_t> near_path(const SideField& field, std::span<const double> path_row) {
  // The sections' own reach and the millimetre that the smoothed path may lie off its columns.
  const auto below_mm = static_cast<float>(SectionConfig{}.below_mm + 1.0);
  const auto above_mm = static_cast<float>(SectionConfig{}.above_mm + 1.0);
  const SideGrid& grid = field.grid;
  std::vector<float> path_z_mm;
  for (const double row : path_row) path_z_mm.push_back(static_cast<float>(grid.z_mm(row)));
  const auto per_col = static_cast<float>(1 / grid.col_mm);
  return items_where(field.places.size(), [&](std::size_t i) {
    const OutlinePlace& place = field.places[i];
    const float s_mm = std::max(place.s_mm, hollow_s_mm(place));
    if (s_mm < 0) return false;
    const auto col = std::min<std::size_t>(path_z_mm.size() - 1, static_cast<std::uint32_t>(s_mm * per_col));
    const float above_path_mm = place.z_mm - path_z_mm[col];
    if (place.s_mm < 0) return std::abs(above_path_mm) < k_hollow_reach_mm;
    return above_path_mm > -below_mm && above_path_mm < above_mm;
  });
}

PlacedLine place_line(const PlacementInput& input, const PlacementConfig& config) {
  PlacedLine placement;
  const Outline& path_outline = input.path.outline;
  const std::vector<double>& path_z = input.path.z_mm;
  const std::size_t stations = path_z.size();
  const SectionInput sectioned{.points = input.near, .outline = path_outline, .path_z_mm = path_z};
  const SectionPoints points{sectioned, {}};
  const double sample_mm = points.sample_mm();
  const std::vector<double> upright_ratio =
      upright_ratio_of(input, path_outline.length_mm() / static_cast<double>(stations));
  const SectionCourseConfig course_config{.along_mm = sigma_along_mm(input.points_per_mm2, sample_mm),
                                          .smoothing_mm = config.smoothing_mm,
                                          .search_mm = config.search_mm,
                                          .mean_mm = config.mean_mm,
                                          .few = are_few(input.points_per_mm2),
                                          .upright_ratio = upright_ratio};
  SectionCourse course = section_course(points, path_z, course_config);
  const Sections& sections = course.sections;
  Ridge& ridge = course.ridge;
  const std::vector<double>& z = course.z_mm;
  std::vector<double> few(stations, 0.0);
  CourseSpread width{.out_mm = few, .up_mm = few};
  if (course_config.few) {
    few = half_spread(sectioned, course, course_config);
    width = width_spread(points, path_z, course, course_config);
  }
  const Plan plan = plan_of(path_outline, course.o_mm, course.o_known, sections.station_mm);
  const std::vector<GapPlace> gap = gap_places(ridge.visible, path_outline, sections.station_mm);
  const std::vector<GapPlace> shadow = gap_places(course.o_known, path_outline, sections.station_mm);
  std::vector<Vec3> normals;
  std::vector<PlaceNoise> noise;
  std::vector<double> tried_z;
  tbb::parallel_invoke(
      [&] {
        normals = normals_above({.points = points,
                                 .sections = sections,
                                 .outline = path_outline,
                                 .line_z_mm = z,
                                 .line_plan = plan.places},
                                config.normals);
      },
      [&] { noise = place_noise(sections, course.row, ridge.visible, config.mean_mm); },
      [&] { tried_z = tried_heights(z, ridge.visible, ridge.visible, sections.station_mm); });
  const std::vector<double> scatter =
      scatter_of(course.seen_z_mm, z, ridge.visible, config.mean_mm, sections.station_mm);

  const std::vector<double> between_o = between_profiles(course.o_mm, sample_mm, sections.station_mm);
  const std::vector<double> between_z = between_profiles(z, sample_mm, sections.station_mm);

  // Bridges are tried where a crease was seen: of a surface that was seen and has none they say nothing.
  // Where the line goes another way there, it leaves this one at once.
  const auto seen_bare = [&](std::size_t i) {
    return gap[i].in_long && shadow[i].to_known_mm == 0 && noise[i].filled_mm == 0;
  };
  const auto untried = [&](std::size_t i) {
    return seen_bare(i) || (gap[i].in_long && tried_z[i] == 0) ||
           (shadow[i].in_long && plan.tried_mm[i] == 0);
  };

  std::vector<std::uint8_t> bare(stations, 0);
  placement.points.resize(stations);
  for (std::size_t i = 0; i < stations; ++i) {
    placement.points[i] = {
        .position = {plan.places[i].x(), plan.places[i].y(), z[i]},
        .normal = normals[i],
        .curvature_per_mm = ridge.k_per_mm[i],
        .own_z_mm = course.seen_z_mm[i],
        .to_visible_mm = gap[i].to_known_mm,
        .doubt = std::max(seen_bare(i) ? gap[i].most_doubt : gap[i].doubt, shadow[i].doubt),
        .corner_mm = plan.corner_mm[i],
        .tried_out_mm = std::max(plan.tried_mm[i], plan.off_mm[i]),
        .tried_up_mm = tried_z[i],
        .untried = untried(i),
        .between_out_mm = std::hypot(between_o[i], width.out_mm[i]),
        .between_up_mm = std::hypot(between_z[i], width.up_mm[i]),
        .few_out_mm = few[i],
        .noise = noise[i],
        .scatter_mm = scatter[i],
        .thing_beside = sections.ended[i] != 0};
    bare[i] = seen_bare(i) ? 1 : 0;
  }
  doubt_bare(bare, ridge, sections.station_mm, config.mean_mm, placement.points);
  set_layers(input, placement.points);
  doubt_ridge(ridge, config.mean_mm / sections.station_mm, placement.points);
  doubt_bridges(ridge.visible, placement.points);
  doubt_bridges(course.o_known, placement.points);
  doubt_things_beside(sections.station_mm, placement.points);
  for (std::size_t i = 0; i < stations; ++i) {
    const double step = (placement.points[(i + 1) % stations].position - placement.points[i].position).norm();
    placement.length_mm += step;
    if (placement.points[i].to_visible_mm > 0) placement.bridged_mm += step;
    if (placement.points[i].thing_beside) placement.thing_beside_mm += step;
  }
  return placement;
}

}  // namespace biteline::bite_line
