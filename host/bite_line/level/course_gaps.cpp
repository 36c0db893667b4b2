// SPDX-License-Identifier: MIT
#include "host/bite_line/level/course_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

std::size_t column(const SideGrid& grid, int col) {
  return geometry::round_index(0, col, static_cast<std::size_t>(grid.cols));
}

}  // namespace

std::vector<CourseGap> gaps_of(const SideGrid& grid, const Layers& layers, const GapConfig& config) {
  constexpr double k_begin_mm = 8.0;  // of crease, before the first gap
  constexpr double k_bent_mm = 8.0;   // of a change: the course bends there
  const int beside = static_cast<int>(std::lround(k_bent_mm / grid.col_mm));
  std::vector<std::uint8_t> on_line = layers.line.visible;
  for (std::size_t col = 0; config.least_turn_rad > 0 && col < on_line.size(); ++col) {
    if (layers.line.turn_rad[col] < config.least_turn_rad) on_line[col] = 0;
  }
  for (const OtherCrease& other : layers.others) {
    for (int k = -beside; k <= other.cols + beside; ++k) on_line[column(grid, other.first_col + k)] = 0;
  }
  int start = -1;
  for (int col = 0, run = 0; col < 2 * grid.cols && start < 0; ++col) {
    run = on_line[column(grid, col)] != 0 ? run + 1 : 0;
    if (run * grid.col_mm >= k_begin_mm) start = col % grid.cols + 1;
  }
  std::vector<CourseGap> gaps;
  if (start < 0) return gaps;
  for (int k = 0; k < grid.cols; ++k) {
    if (on_line[column(grid, start + k)] != 0) continue;
    const int col = start + k;
    if (!gaps.empty() && (col - gaps.back().first - gaps.back().cols) * grid.col_mm < config.island_mm)
      gaps.back().cols = col + 1 - gaps.back().first;
    else
      gaps.push_back({.first = col, .cols = 1});
  }
  for (CourseGap& gap : gaps) {
    gap.changes = std::ranges::any_of(layers.others, [&](const OtherCrease& other) {
      return static_cast<int>(column(grid, other.first_col - gap.first)) < gap.cols;
    });
  }
  std::erase_if(gaps, [&](const CourseGap& gap) { return gap.cols * grid.col_mm < config.least_mm; });
  return gaps;
}

double CourseOverS::z_mm(double s_mm) const {
  const double col = s_mm / grid_.col_mm - 0.5;
  const double share = col - std::floor(col);
  const int first = static_cast<int>(std::floor(col));
  return grid_.z_mm((1 - share) * line_.row[column(grid_, first)] +
                    share * line_.row[column(grid_, first + 1)]);
}

double CourseOverS::jump_mm(const CourseGap& gap) const {
  constexpr double k_lever_mm = 6.0, k_least_mm = 2.0;
  const double from_mm = gap.first * grid_.col_mm, to_mm = from_mm + gap.cols * grid_.col_mm;
  const double rise = z_mm(to_mm) - z_mm(from_mm);
  const double before = (z_mm(from_mm) - z_mm(from_mm - k_lever_mm)) / k_lever_mm;
  const double after = (z_mm(to_mm + k_lever_mm) - z_mm(to_mm)) / k_lever_mm;
  const double jump = rise - (to_mm - from_mm) * (before + after) / 2;
  return std::abs(jump) < k_least_mm ? 0 : jump;
}

double CourseOverS::off_mm(const Vec2& place) const {
  constexpr double k_reach_mm = 12.0;
  double nearest = std::numeric_limits<double>::max();
  for (double d = -k_reach_mm; d <= k_reach_mm; d += Patch::k_cell_mm)
    nearest = std::min(nearest, std::hypot(d, z_mm(place.x() + d) - place.y()));
  return nearest;
}

double CourseOverS::cost(const Patch& patch, const StepCosts& costs, double from_mm, double to_mm) const {
  constexpr double k_direction_rad = std::numbers::pi / 8;
  double sum = 0;
  for (double s = from_mm; s < to_mm; s += Patch::k_cell_mm) {
    const double rise = z_mm(s + Patch::k_cell_mm) - z_mm(s);
    const auto k = std::lround(std::atan2(rise, Patch::k_cell_mm) / k_direction_rad);
    const Cell cell = patch.cell({s, z_mm(s)});
    sum +=
        std::hypot(rise, Patch::k_cell_mm) *
        static_cast<double>(costs[geometry::round_index(0, k, costs.size())][patch.at(cell.row, cell.col)]);
  }
  return sum;
}

}  // namespace biteline::bite_line
