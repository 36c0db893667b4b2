// SPDX-License-Identifier: MIT
#include "host/bite_line/place/path_curve.hpp"

#include <algorithm>
#include <cmath>

#include "host/geometry/bridge.hpp"
#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

std::vector<Vec3> points_of(const SideField& field, const Outline& outline,
                            std::span<const double> path_row) {
  const SideGrid& grid = field.grid;
  const auto cols = static_cast<std::ptrdiff_t>(grid.cols);
  const auto wrap = [&](std::ptrdiff_t c) { return static_cast<std::size_t>((c % cols + cols) % cols); };
  std::vector<Vec3> points(static_cast<std::size_t>(cols), Vec3::Zero());
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(cols), 0);
  for (std::ptrdiff_t c = 0; c < cols; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const int row = std::clamp(static_cast<int>(std::lround(path_row[i])), 0, grid.rows - 1);
    const std::size_t cell = grid.at(row, static_cast<int>(c));
    seen[i] = field.seen[cell];
    const double s = (static_cast<double>(c) + 0.5) * grid.col_mm;
    const Vec2 plan = outline.point(s) + static_cast<double>(field.o_mm[cell]) * outline.normal(s);
    points[i] = {plan.x(), plan.y(), grid.z_mm(path_row[i])};
  }
  // The columns beside a gap lean on points from one side only.
  const auto margin = static_cast<std::ptrdiff_t>(std::ceil(3.0 / grid.col_mm));
  std::vector<std::uint8_t> known = seen;
  for (std::ptrdiff_t c = 0; c < cols; ++c) {
    if (seen[wrap(c)] != 0) continue;
    for (std::ptrdiff_t j = -margin; j <= margin; ++j) known[wrap(c + j)] = 0;
  }
  const auto lever = static_cast<std::ptrdiff_t>(std::ceil(2 * geometry::k_end_lever_mm / grid.col_mm));
  for (const geometry::Gap& gap : geometry::gaps_of(known)) {
    if (gap.steps >= points.size()) break;  // one known column alone has no direction
    const auto first = static_cast<std::ptrdiff_t>(gap.first);
    const std::ptrdiff_t last = first + static_cast<std::ptrdiff_t>(gap.steps);
    const auto direction = [&](std::ptrdiff_t at, std::ptrdiff_t away) {
      return geometry::CurveEnd{.end = points[wrap(at)],
                                .near = points[wrap(at + away * lever / 2)],
                                .far = points[wrap(at + away * lever)]}
          .direction();
    };
    const geometry::Arc arc{.p0 = points[wrap(first)],
                            .d0 = direction(first, -1),
                            .p1 = points[wrap(last)],
                            .d1 = -direction(last, +1)};
    for (std::ptrdiff_t j = first + 1; j < last; ++j)
      points[wrap(j)] = arc.at(static_cast<double>(j - first) / static_cast<double>(gap.steps));
  }
  return points;
}

/// Heights of points at scattered s, at evenly spaced stations of their own outline.
std::vector<double> heights_at_stations(std::span<const Vec3> path, const Outline& path_outline,
                                        std::size_t stations) {
  struct Sample {
    double s, z;
  };
  std::vector<Eigen::Vector3f> points;
  for (const Vec3& p : path) points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
  std::vector<OutlinePlace> feet(points.size());
  path_outline.locate(points, feet);
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    if (feet[i].s_mm >= 0) samples.push_back({static_cast<double>(feet[i].s_mm), path[i].z()});
  }
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.s < b.s; });
  const double length = path_outline.length_mm();
  samples.insert(samples.begin(), {samples.back().s - length, samples.back().z});
  samples.push_back({samples[1].s + length, samples[1].z});
  std::vector<double> z(stations);
  std::size_t k = 0;
  for (std::size_t i = 0; i < stations; ++i) {
    const double s = length * static_cast<double>(i) / static_cast<double>(stations);
    while (k + 2 < samples.size() && samples[k + 1].s <= s) ++k;
    const double span = std::max(samples[k + 1].s - samples[k].s, 1e-9);
    z[i] = samples[k].z + std::clamp((s - samples[k].s) / span, 0.0, 1.0) * (samples[k + 1].z - samples[k].z);
  }
  return geometry::smooth_closed(z, 3.0 / (length / static_cast<double>(stations)));
}

}  // namespace

PathCurve curve_of(const SideField& field, const Outline& outline, std::span<const double> path_row,
                   double spacing_mm) {
  const std::vector<Vec3> points = points_of(field, outline, path_row);
  std::vector<Vec2> plan;
  for (const Vec3& p : points) plan.push_back(p.head<2>());
  PathCurve curve{.outline = Outline{plan, {.spacing_mm = 0.5, .smoothing_mm = 4.0, .reach_mm = 18.0}},
                  .z_mm = {}};
  const double stations = std::max(32.0, std::round(curve.outline.length_mm() / spacing_mm));
  curve.z_mm = heights_at_stations(points, curve.outline, static_cast<std::size_t>(stations));
  return curve;
}

}  // namespace biteline::bite_line
