// SPDX-License-Identifier: MIT
#include "host/bite_line/side/side_normal.hpp"

#include <algorithm>

namespace biteline::bite_line {

SideCell cell_of(const SideGrid& grid, const OutlinePlace& place) {
  return {.row = static_cast<int>((static_cast<double>(place.z_mm) - grid.z_low_mm) / grid.row_mm),
          .col = static_cast<int>(static_cast<double>(place.s_mm) / grid.col_mm) % grid.cols};
}

std::optional<Vec3> field_normal(const Side& side, const SideCell& cell) {
  const SideField& field = side.field;
  const SideGrid& grid = field.grid;
  if (cell.row < 1 || cell.row > grid.rows - 2) return std::nullopt;
  const auto at = [&](int dr, int dc) {
    return grid.at(cell.row + dr, (cell.col + dc + grid.cols) % grid.cols);
  };
  const auto o = [&](int dr, int dc) { return static_cast<double>(field.o_mm[at(dr, dc)]); };
  const auto seen = [&](int dr, int dc) { return field.seen[at(dr, dc)] != 0; };
  if (!seen(1, 0) || !seen(-1, 0) || !seen(0, 2) || !seen(0, -2)) return std::nullopt;
  const double s_mm = (cell.col + 0.5) * grid.col_mm;
  const Vec2 out = side.outline.normal(s_mm);
  const Vec2 along{-out.y(), out.x()};
  // At o outside the outline a step along it is (1 + bend o) as long.
  const double stretch = std::max(0.3, 1.0 + side.outline.bend_per_mm(s_mm) * o(0, 0));
  Vec3 normal{0, 0, -(o(1, 0) - o(-1, 0)) / (2 * grid.row_mm)};
  normal.head<2>() = out - (o(0, 2) - o(0, -2)) / (4 * grid.col_mm * stretch) * along;
  return normal.normalized();
}

Vec3 normal_above(const Side& side, const Vec3& p) {
  const SideGrid& grid = side.field.grid;
  const OutlinePlace foot = side.outline.locate(Eigen::Vector3f{p.cast<float>()});
  const SideCell here = cell_of(grid, foot);
  const Vec2 out = side.outline.normal(static_cast<double>(foot.s_mm));
  const auto rows_of = [&](double mm) { return static_cast<int>(mm / grid.row_mm); };
  Vec3 sum = 1e-3 * Vec3{out.x(), out.y(), 0};
  for (int row = here.row + rows_of(2.0); row <= here.row + rows_of(6.0); ++row) {
    if (const std::optional<Vec3> normal = field_normal(side, {row, here.col})) sum += *normal;
  }
  return sum.normalized();
}

}  // namespace biteline::bite_line
