// SPDX-License-Identifier: MIT
#include "host/calibration/rings/lattice.hpp"

#include <algorithm>
#include <cmath>

#include "host/calibration/rings/homography.hpp"

namespace biteline::calibration {

namespace {

/// Target frame of reading `other` in that of reading `first`, both of one lattice.
SE3 between(const Numbering& first, const Numbering& other, double pitch_mm) {
  const auto place = [&](const Numbering& numbering, Cell cell) {
    const Cell target_cell = numbering.apply(cell);
    return Vec2(target_cell.second * pitch_mm, target_cell.first * pitch_mm);
  };
  const Vec2 o_first = place(first, {0, 0}), x_first = place(first, {0, 1}) - o_first;
  const Vec2 o_other = place(other, {0, 0}), x_other = place(other, {0, 1}) - o_other;
  const double turn_rad = std::atan2(x_first.y(), x_first.x()) - std::atan2(x_other.y(), x_other.x());
  SE3 T_first_other = SE3::Identity();
  T_first_other.linear() = Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()).toRotationMatrix();
  const Vec2 shift = o_first - T_first_other.linear().topLeftCorner<2, 2>() * o_other;
  T_first_other.translation() = Vec3(shift.x(), shift.y(), 0);
  return T_first_other;
}

}  // namespace

Extent extent_of(const Lattice& lattice) {
  Extent extent;
  for (const auto& [cell, index] : lattice) extent.include(cell);
  return extent;
}

std::optional<Mat3> lattice_homography(const Lattice& lattice, const std::vector<Ring>& rings) {
  std::vector<PlanePoint> points;
  points.reserve(lattice.size());
  for (const auto& [cell, index] : lattice) {
    points.push_back({.plane = Vec2(cell.second, cell.first), .image = rings[index].centre_px});
  }
  return fit_homography(points);
}

std::optional<Mat3> local_homography(const Lattice& lattice, const std::vector<Ring>& rings, Cell about,
                                     int reach) {
  Lattice near;
  for (const auto& [cell, index] : lattice) {
    if (std::abs(cell.first - about.first) <= reach && std::abs(cell.second - about.second) <= reach)
      near[cell] = index;
  }
  return near.size() >= 4 ? lattice_homography(near, rings) : std::nullopt;
}

std::vector<Numbering> numberings(const Lattice& lattice, const RingTarget& target) {
  std::vector<Numbering> result;
  for (int turns = 0; turns < 4; ++turns) {
    Extent extent;
    for (const auto& [cell, index] : lattice) extent.include(Numbering{.quarter_turns = turns}.apply(cell));
    for (int row = 0; row + extent.rows() <= target.rows; ++row) {
      for (int col = 0; col + extent.cols() <= target.cols; ++col) {
        result.push_back(
            {.quarter_turns = turns, .row_shift = row - extent.min_row, .col_shift = col - extent.min_col});
      }
    }
  }
  return result;
}

std::optional<GridView> numbered(const Lattice& lattice, const std::vector<Ring>& rings,
                                 const RingTarget& target, const std::vector<Numbering>& readings) {
  const int least = std::max(k_least_grid_rings, static_cast<int>(std::ceil(0.4 * target.rings())));
  if (static_cast<int>(lattice.size()) < std::min(least, target.rings())) return std::nullopt;
  if (readings.empty()) return std::nullopt;
  GridView view;
  for (const auto& [cell, index] : lattice) {
    const Cell place = readings.front().apply(cell);
    view.rings.push_back({.ring = rings[index], .row = place.first, .col = place.second});
  }
  std::sort(view.rings.begin(), view.rings.end(), [](const GridRing& a, const GridRing& b) {
    return std::pair(a.row, a.col) < std::pair(b.row, b.col);
  });
  view.missing = target.rings() - static_cast<int>(view.rings.size());
  for (const Numbering& numbering : readings)
    view.readings.push_back({.T_this_other = between(readings.front(), numbering, target.pitch_mm)});
  return view;
}

}  // namespace biteline::calibration
