// SPDX-License-Identifier: MIT
#include "host/bite_line/place/path_curve.hpp"

#include <algorithm>
#include <cmath>

#include "host/bite_line/place/bridge.hpp"

namespace biteline::bite_line {

PathCurve curve_of(const SideField& field, const Outline& outline, std::span<const double> path_row) {
  const SideGrid& grid = field.grid;
  const auto cols = static_cast<std::ptrdiff_t>(grid.cols);
  const auto wrap = [&](std::ptrdiff_t c) { return static_cast<std::size_t>((c % cols + cols) % cols); };
  std::vector<Vec3> points(static_cast<std::size_t>(cols), Vec3::Zero());
  std::vector<bool> seen(static_cast<std::size_t>(cols), false);
  for (std::ptrdiff_t c = 0; c < cols; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const int row = std::clamp(static_cast<int>(std::lround(path_row[i])), 0, grid.rows - 1);
    const std::size_t cell = grid.at(row, static_cast<int>(c));
    seen[i] = field.seen[cell] != 0;
    const double s = (static_cast<double>(c) + 0.5) * grid.col_mm;
    const Vec2 plan = outline.point(s) + static_cast<double>(field.o_mm[cell]) * outline.normal(s);
    points[i] = {plan.x(), plan.y(), grid.z_mm(path_row[i])};
  }
  // The columns beside a gap lean on points from one side only.
  const auto margin = static_cast<std::ptrdiff_t>(std::ceil(3.0 / grid.col_mm));
  std::vector<bool> known = seen;
  for (std::ptrdiff_t c = 0; c < cols; ++c) {
    if (seen[wrap(c)]) continue;
    for (std::ptrdiff_t j = -margin; j <= margin; ++j) known[wrap(c + j)] = false;
  }
  const auto lever = static_cast<std::ptrdiff_t>(std::ceil(12.0 / grid.col_mm));
  for (std::ptrdiff_t c = 0; c < cols; ++c) {
    if (!known[wrap(c)] || known[wrap(c + 1)]) continue;
    std::ptrdiff_t end = c + 1;
    while (end < c + cols && !known[wrap(end)]) ++end;
    if (end >= c + cols) break;
    // Directions over 12 mm outside the gap, turned on by the bend over those 12 mm to stand at the gap's
    // edge.
    const auto direction = [&](std::ptrdiff_t at, std::ptrdiff_t away) {
      const Vec3 near = points[wrap(at)] - points[wrap(at + away * lever / 2)];
      const Vec3 far = points[wrap(at + away * lever / 2)] - points[wrap(at + away * lever)];
      return Vec3{(1.5 * near - 0.5 * far) / (0.5 * static_cast<double>(lever))};
    };
    const Arc arc{
        .p0 = points[wrap(c)], .d0 = direction(c, -1), .p1 = points[wrap(end)], .d1 = -direction(end, +1)};
    for (std::ptrdiff_t j = c + 1; j < end; ++j)
      points[wrap(j)] = arc.at(static_cast<double>(j - c) / static_cast<double>(end - c));
    c = end - 1;
  }
  PathCurve curve;
  for (const Vec3& p : points) {
    curve.plan.push_back(p.head<2>());
    curve.z_mm.push_back(p.z());
  }
  return curve;
}

std::vector<double> heights_at_stations(const PathCurve& curve, const Outline& path_outline,
                                        std::size_t stations) {
  struct Sample {
    double s, z;
  };
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < curve.plan.size(); ++i) {
    const OutlinePlace foot = path_outline.locate(
        {static_cast<float>(curve.plan[i].x()), static_cast<float>(curve.plan[i].y()), 0.0F});
    if (foot.s_mm >= 0) samples.push_back({static_cast<double>(foot.s_mm), curve.z_mm[i]});
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
  return smooth_closed(z, 3.0 / (length / static_cast<double>(stations)));
}

}  // namespace biteline::bite_line
