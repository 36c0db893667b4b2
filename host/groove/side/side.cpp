// SPDX-License-Identifier: MIT
#include "host/groove/side/side.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::groove {

namespace {

/// Plan of the lower side: hull of the points up to 45 mm above the lowest, which is where bite lines are.
Outline side_outline(const std::vector<Eigen::Vector3f>& points) {
  constexpr float k_band_mm = 45.0F;
  constexpr float k_cell_mm = 1.0F;
  float lowest = 1e9F;
  float reach = 0;
  for (const Eigen::Vector3f& p : points) {
    lowest = std::min(lowest, p.z());
    reach = std::max({reach, std::abs(p.x()), std::abs(p.y())});
  }
  // Only the outermost point of each row of the plan can lie on the hull.
  const auto half = static_cast<std::size_t>(reach / k_cell_mm) + 1;
  std::vector<std::pair<Vec2, Vec2>> ends(2 * half + 1, {Vec2{1e9, 0}, Vec2{-1e9, 0}});
  for (const Eigen::Vector3f& p : points) {
    if (p.z() > lowest + k_band_mm) continue;
    auto& [low, high] =
        ends[static_cast<std::size_t>(std::floor(p.y() / k_cell_mm) + static_cast<float>(half))];
    if (static_cast<double>(p.x()) < low.x()) low = p.head<2>().cast<double>();
    if (static_cast<double>(p.x()) > high.x()) high = p.head<2>().cast<double>();
  }
  std::vector<Vec2> plan;
  for (const auto& [low, high] : ends) {
    if (low.x() > 1e8) continue;
    plan.push_back(low);
    plan.push_back(high);
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
  Outline outline = clock.run("outline", [&] { return side_outline(shoe.points); });
  SideField field = clock.run("unroll", [&] { return SideField::build(shoe.points, outline, {}); });
  return Side{std::move(shoe), std::move(outline), std::move(field)};
}

Vec3 normal_from_field(const Side& side, const Vec3& p) {
  const SideGrid& grid = side.field.grid;
  const auto foot = side.outline.locate(static_cast<float>(p.x()), static_cast<float>(p.y()));
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

}  // namespace biteline::groove
