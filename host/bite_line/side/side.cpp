// SPDX-License-Identifier: MIT
#include "host/bite_line/side/side.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace biteline::bite_line {

namespace {

/// Plan of the lower side: hull of the points up to 45 mm above the lowest, which is where bite lines are.
Outline side_outline(const Shoe& shoe) {
  constexpr float k_band_mm = 45.0F;
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
          const auto row = static_cast<std::size_t>((p.y() - shoe.box.min().y()) / k_cell_mm);
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

}  // namespace

std::optional<Side> make_side(std::span<const Eigen::Vector3f> points, StageClock& clock,
                              Extraction& extraction) {
  Shoe shoe = clock.run("shoe", [&] { return find_shoe(points); });
  extraction.T_base_shoe = shoe.T_base_shoe;
  if (!shoe.found) {
    extraction.reason = shoe.reason;
    return std::nullopt;
  }
  Outline outline = clock.run("outline", [&] { return side_outline(shoe); });
  SideField field = clock.run("unroll", [&] { return SideField::build(shoe, outline, {}); });
  return Side{std::move(shoe), std::move(outline), std::move(field)};
}

Vec3 normal_from_field(const Side& side, const Vec3& p) {
  const SideGrid& grid = side.field.grid;
  const auto foot = side.outline.locate(Eigen::Vector3f{p.cast<float>()});
  const Vec2 out = side.outline.normal(static_cast<double>(foot.s_mm));
  const Vec2 along{-out.y(), out.x()};
  const int col = static_cast<int>(static_cast<double>(foot.s_mm) / grid.col_mm) % grid.cols;
  const int row = static_cast<int>((p.z() - grid.z_low_mm) / grid.row_mm);
  const auto rows_of = [&](double mm) { return static_cast<int>(mm / grid.row_mm); };
  Vec3 sum = 1e-3 * Vec3{out.x(), out.y(), 0};
  for (int r = std::max(1, row + rows_of(2.0)); r <= std::min(grid.rows - 2, row + rows_of(6.0)); ++r) {
    const auto o = [&](int dr, int dc) {
      return static_cast<double>(side.field.o_mm[grid.at(r + dr, (col + dc + grid.cols) % grid.cols)]);
    };
    const auto seen = [&](int dr, int dc) {
      return side.field.seen[grid.at(r + dr, (col + dc + grid.cols) % grid.cols)] != 0;
    };
    if (!seen(1, 0) || !seen(-1, 0) || !seen(0, 2) || !seen(0, -2)) continue;
    Vec3 normal{0, 0, -(o(1, 0) - o(-1, 0)) / (2 * grid.row_mm)};
    const double stretch =
        std::max(0.3, 1.0 + side.outline.bend_per_mm(static_cast<double>(foot.s_mm)) * o(0, 0));
    normal.head<2>() = out - (o(0, 2) - o(0, -2)) / (4 * grid.col_mm * stretch) * along;
    sum += normal.normalized();
  }
  return sum.normalized();
}

}  // namespace biteline::bite_line
