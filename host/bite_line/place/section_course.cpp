// SPDX-License-Identifier: MIT
#include "host/bite_line/place/section_course.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "host/bite_line/place/gap_bridge.hpp"
#include "host/geometry/bridge.hpp"
#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

/// Three profiles of a usual scan: less, with nothing around, may be strays.
constexpr double k_island_mm = 3.0;

struct Surface {
  double o_mm;
  bool seen;  ///< and not only a straight line across a shadow, which hides the depth of a groove
};

std::optional<Surface> surface_at(const Sections& sections, int station, double row) {
  // How far from the row a point may be that has seen it.
  constexpr double k_beside_mm = 0.2;
  const int below = static_cast<int>(std::floor(row));
  const int beside = static_cast<int>(std::lround(k_beside_mm / sections.row_mm));
  if (below < 0 || below + 1 >= sections.rows) return std::nullopt;
  const std::size_t low = sections.at(station, below);
  const std::size_t high = sections.at(station, below + 1);
  if (sections.known[low] == Sections::k_nothing || sections.known[high] == Sections::k_nothing)
    return std::nullopt;
  bool seen = false;
  for (int r = std::max(0, below - beside); r <= std::min(sections.rows - 1, below + 1 + beside); ++r)
    seen = seen || sections.known[sections.at(station, r)] == Sections::k_seen;
  const double fraction = row - below;
  return Surface{.o_mm = (1 - fraction) * static_cast<double>(sections.o_mm[low]) +
                         fraction * static_cast<double>(sections.o_mm[high]),
                 .seen = seen};
}

/// Rows of one section, [low, end).
struct Hole {
  int low{0};
  int end{0};
};

/// What was not seen of a section nearest to `row`: within `reach` rows, with the sole's edge standing out
/// below it or nothing below it, and the wall above.
std::optional<Hole> hole_near(const Sections& sections, int station, double row, double reach) {
  const auto known = [&](int r) { return sections.known[sections.at(station, r)] != Sections::k_nothing; };
  std::optional<Hole> nearest;
  double nearest_rows = reach;
  for (int low = 0; low < sections.rows;) {
    if (known(low)) {
      ++low;
      continue;
    }
    int end = low;
    while (end < sections.rows && !known(end)) ++end;
    const bool stands_out = low == 0 || (end < sections.rows && sections.o_mm[sections.at(station, low - 1)] >
                                                                    sections.o_mm[sections.at(station, end)]);
    const double away = std::max({low - row, row - end, 0.0});
    if (end < sections.rows && stands_out && away <= nearest_rows) {
      nearest = Hole{.low = low, .end = end};
      nearest_rows = away;
    }
    low = end;
  }
  return nearest;
}

/// Where a section shows no crease, it lies in what was not seen: a bridge that leaves the hole of its
/// section is led back to the hole's edge.
void keep_in_holes(const Sections& sections, const Ridge& ridge, std::span<const double> path_z_mm,
                   std::vector<double>& z_mm) {
  constexpr double k_reach_mm = 1.5;
  for (std::size_t i = 0; i < z_mm.size(); ++i) {
    if (ridge.k_per_mm[i] >= k_least_curvature_per_mm) continue;
    const double row = sections.zero_row + (z_mm[i] - path_z_mm[i]) / sections.row_mm;
    const std::optional<Hole> hole =
        hole_near(sections, static_cast<int>(i), row, k_reach_mm / sections.row_mm);
    if (!hole) continue;
    const double inside = std::clamp(row, static_cast<double>(hole->low), static_cast<double>(hole->end));
    z_mm[i] += (inside - row) * sections.row_mm;
  }
}

/// How far out the line lies at every station, and where that is known.
struct Outwards {
  std::vector<double> o_mm;
  std::vector<std::uint8_t> known;
};

Outwards outwards_of(const Sections& sections, std::span<const double> row) {
  // Over longer stretches a groove in shadow is better guessed by the straight line across it than from its
  // ends.
  constexpr double k_longest_shadow_mm = 12.0;
  Outwards out{std::vector<double>(row.size(), 0.0), std::vector<std::uint8_t>(row.size(), 0)};
  std::vector<std::uint8_t> filled(row.size(), 0);
  for (std::size_t i = 0; i < row.size(); ++i) {
    const std::optional<Surface> surface = surface_at(sections, static_cast<int>(i), row[i]);
    if (!surface) continue;
    out.o_mm[i] = surface->o_mm;
    out.known[i] = surface->seen ? 1 : 0;
    filled[i] = surface->seen ? 0 : 1;
  }
  if (std::find(out.known.begin(), out.known.end(), 1) == out.known.end()) out.known = filled;
  for (const geometry::Gap& gap : geometry::gaps_of(std::vector<std::uint8_t>{out.known})) {
    if (static_cast<double>(gap.steps) * sections.station_mm <= k_longest_shadow_mm) continue;
    for (std::size_t k = 1; k < gap.steps; ++k) {
      const std::size_t i = (gap.first + k) % row.size();
      if (filled[i] != 0) out.known[i] = 1;
    }
  }
  return out;
}

/// What lies beside an unseen stretch leans on points from one side only: a millimetre of it is not taken.
void shrink_beside_gaps(std::vector<std::uint8_t>& known, double station_mm) {
  constexpr double k_long_mm = 3.0;
  constexpr double k_margin_mm = 1.0;
  const auto margin = static_cast<std::size_t>(std::lround(k_margin_mm / station_mm));
  const std::size_t count = known.size();
  for (const geometry::Gap& gap : geometry::gaps_of(known)) {
    if (static_cast<double>(gap.steps) * station_mm < k_long_mm) continue;
    for (std::size_t k = 0; k < margin; ++k) {
      known[(gap.first + count - k) % count] = 0;
      known[(gap.first + gap.steps + k) % count] = 0;
    }
  }
}

/// Mean of what is known over so many stations about each that is.
void mean_of_known(Outwards& outwards, double stations) {
  std::vector<double> share(outwards.known.begin(), outwards.known.end());
  std::vector<double> sum(share.size());
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = share[i] * outwards.o_mm[i];
  share = geometry::running_mean(share, stations);
  sum = geometry::running_mean(sum, stations);
  for (std::size_t i = 0; i < sum.size(); ++i)
    if (outwards.known[i] != 0) outwards.o_mm[i] = sum[i] / share[i];
}

/// Bridged by straight lines.  `few`: a place then hangs on one or two points, and on those beside it.
Outwards whole_outwards(const Sections& sections, std::span<const double> row, bool few) {
  constexpr double k_few_mean_mm = 4.0;
  Outwards outwards = outwards_of(sections, row);
  geometry::drop_islands(outwards.known, sections.station_mm, k_island_mm);
  shrink_beside_gaps(outwards.known, sections.station_mm);
  if (few) mean_of_known(outwards, k_few_mean_mm / sections.station_mm);
  geometry::bridge_straight(outwards.o_mm, outwards.known, sections.station_mm);
  return outwards;
}

}  // namespace

SectionCourse section_course(const SectionPoints& points, std::span<const double> path_z_mm,
                             const SectionCourseConfig& config) {
  SectionCourse course;
  course.sections = points.cut(config.along_mm);
  const Sections& sections = course.sections;
  const double station_mm = sections.station_mm;
  course.ridge = follow_ridge(
      sections, section_curvature(sections, config.smoothing_mm, config.upright_ratio), config.search_mm);
  geometry::drop_islands(course.ridge.visible, station_mm, k_island_mm);

  const std::size_t stations = path_z_mm.size();
  course.seen_z_mm.resize(stations);
  for (std::size_t i = 0; i < stations; ++i)
    course.seen_z_mm[i] = path_z_mm[i] + sections.z_mm(course.ridge.row[i]);
  std::vector<double> whole_z = course.seen_z_mm;
  std::vector<std::uint8_t> firm = course.ridge.visible;
  shrink_beside_gaps(firm, station_mm);
  geometry::bridge_smooth(whole_z, firm, station_mm, k_height_lever_mm);
  keep_in_holes(sections, course.ridge, path_z_mm, whole_z);
  course.z_mm = geometry::running_mean(whole_z, config.mean_mm / station_mm);
  course.row.resize(stations);
  for (std::size_t i = 0; i < stations; ++i)
    course.row[i] = sections.zero_row + (course.z_mm[i] - path_z_mm[i]) / sections.row_mm;

  Outwards outwards = whole_outwards(sections, course.row, config.few);
  course.o_mm = std::move(outwards.o_mm);
  course.o_known = std::move(outwards.known);
  return course;
}

std::vector<double> half_spread(const SectionInput& input, const SectionCourse& whole,
                                const SectionCourseConfig& config) {
  std::array<std::vector<Eigen::Vector3f>, 2> half;
  for (std::size_t i = 0; i < input.points.size(); ++i) half[i % 2].push_back(input.points[i]);
  const auto out_of = [&](std::span<const Eigen::Vector3f> points) {
    const SectionPoints sorted{{.points = points, .outline = input.outline, .path_z_mm = input.path_z_mm},
                               {}};
    return whole_outwards(sorted.cut(config.along_mm), whole.row, config.few).o_mm;
  };
  const std::vector<double> a = out_of(half[0]);
  const std::vector<double> b = out_of(half[1]);

  const std::size_t stations = whole.row.size();
  std::vector<double> mm2(stations, 0.0), seen(stations, 0.0);
  for (std::size_t i = 0; i < stations; ++i) {
    if (whole.o_known[i] == 0) continue;
    const double noise = 0.5 * (a[i] - b[i]);
    const double bend = 0.5 * (a[i] + b[i]) - whole.o_mm[i];
    mm2[i] = noise * noise + bend * bend;
    seen[i] = 1;
  }
  const double steps = config.mean_mm / whole.sections.station_mm;
  std::vector<double> sigma = geometry::running_mean(mm2, steps);
  const std::vector<double> share = geometry::running_mean(seen, steps);
  for (std::size_t i = 0; i < stations; ++i)
    sigma[i] = std::sqrt(std::max(sigma[i], 0.0) / std::max(share[i], 1 / steps));
  return sigma;
}

CourseSpread width_spread(const SectionPoints& points, std::span<const double> path_z_mm,
                          const SectionCourse& whole, const SectionCourseConfig& config) {
  constexpr double k_wider = 1.5;
  constexpr double k_more = k_wider * k_wider - 1;
  SectionCourseConfig wider = config;
  wider.along_mm *= k_wider;
  const SectionCourse wide = section_course(points, path_z_mm, wider);
  const std::size_t stations = whole.row.size();
  CourseSpread spread{.out_mm = std::vector<double>(stations, 0.0),
                      .up_mm = std::vector<double>(stations, 0.0)};
  for (std::size_t i = 0; i < stations; ++i) {
    if (whole.o_known[i] == 0 || wide.o_known[i] == 0) continue;
    spread.out_mm[i] = std::abs(wide.o_mm[i] - whole.o_mm[i]) / k_more;
    spread.up_mm[i] = std::abs(wide.z_mm[i] - whole.z_mm[i]) / k_more;
  }
  return spread;
}

}  // namespace biteline::bite_line
