// SPDX-License-Identifier: MIT
#include "host/bite_line/side/side_outline.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

constexpr float k_band_mm = 45.0F;

}  // namespace

Outline side_outline(const Shoe& shoe) {
  constexpr float k_cell_mm = 1.0F;
  // Only the outermost point of each row of the plan can lie on the hull.
  using Ends = std::vector<std::pair<Eigen::Vector2f, Eigen::Vector2f>>;
  const auto rows = static_cast<std::size_t>(shoe.box.sizes().y() / k_cell_mm) + 1;
  const auto widen = [](Ends::value_type& row, const Ends::value_type& by) {
    if (by.first.x() < row.first.x()) row.first = by.first;
    if (by.second.x() > row.second.x()) row.second = by.second;
  };
  const Ends ends = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>{0, shoe.points.size(), 8192}, Ends(rows, {{1e9F, 0}, {-1e9F, 0}}),
      [&](const auto& range, Ends seen) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const Eigen::Vector3f& p = shoe.points[i];
          if (shoe.alone[i] != 0 || p.z() > shoe.box.min().z() + k_band_mm) continue;
          const auto row = static_cast<std::uint32_t>((p.y() - shoe.box.min().y()) / k_cell_mm);
          widen(seen[row], {p.head<2>(), p.head<2>()});
        }
        return seen;
      },
      [&](Ends a, const Ends& b) {
        for (std::size_t row = 0; row < a.size(); ++row) widen(a[row], b[row]);
        return a;
      });
  std::vector<Vec2> plan;
  for (const auto& [low, high] : ends) {
    if (low.x() > 1e8F) continue;
    plan.push_back(low.cast<double>());
    plan.push_back(high.cast<double>());
  }
  return Outline{convex_hull(std::move(plan)), {}};
}

std::vector<Vec2> side_reach(const Side& side) {
  constexpr int k_every_col = 2;
  constexpr int k_every_row = 2;
  constexpr double k_inside_share = 0.9;
  constexpr std::size_t k_fewest = 5;
  // A pin, a clamp or a strap's end is shorter along the outline, and none of a shoe's shape.
  constexpr double k_least_part_mm = 40;
  const SideField& field = side.field;
  const SideGrid& grid = field.grid;
  const int rows = std::min(grid.rows, static_cast<int>(static_cast<double>(k_band_mm) / grid.row_mm));
  std::vector<double> s_mm, reach_mm;
  std::vector<float> out_mm;
  for (int col = 0; col < grid.cols; col += k_every_col) {
    out_mm.clear();
    for (int row = 0; row < rows; row += k_every_row) {
      const std::size_t cell = grid.at(row, col);
      if (field.seen[cell] != 0) out_mm.push_back(field.o_mm[cell]);
    }
    if (out_mm.size() < k_fewest) continue;
    const auto at =
        out_mm.begin() + static_cast<std::ptrdiff_t>(k_inside_share * static_cast<double>(out_mm.size()));
    std::nth_element(out_mm.begin(), at, out_mm.end());
    s_mm.push_back((col + 0.5) * grid.col_mm);
    reach_mm.push_back(static_cast<double>(*at));
  }
  reach_mm = geometry::running_median(
      reach_mm, static_cast<std::size_t>(0.5 * k_least_part_mm / (k_every_col * grid.col_mm)));
  std::vector<Vec2> reach;
  for (std::size_t i = 0; i < s_mm.size(); ++i)
    reach.push_back(side.outline.point(s_mm[i]) + reach_mm[i] * side.outline.normal(s_mm[i]));
  return reach;
}

}  // namespace biteline::bite_line
