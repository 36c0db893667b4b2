// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/sight.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace biteline::path {
namespace {

// Finer cells than a scan's profiles leave holes, and tell no more than the wall's own roughness.
constexpr double k_least_cell_mm = 1.5;
constexpr double k_own_surface_cells = 3;
// The line, and what of the upper its normals are measured on (2 to 6 mm above it).
constexpr std::array k_heights_mm{1.0, 3.5, 6.0};
constexpr double k_longest_unseen_mm = 5;  // the extraction bridges as much

std::size_t count_of(const Eigen::Array3i& size) {
  return static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()) *
         static_cast<std::size_t>(size.z());
}

}  // namespace

Occupancy::Occupancy(std::span<const Eigen::Vector3f> points, double spacing_mm)
    : cell_mm_{std::max(k_least_cell_mm, spacing_mm)} {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points) box.extend(p);
  if (points.empty()) return;
  low_ = box.min().cast<double>().array();
  size_ = ((box.max().cast<double>().array() - low_) / cell_mm_).floor().cast<int>() + 1;
  cells_.resize(count_of(size_), false);
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Array3i at = ((p.cast<double>().array() - low_) / cell_mm_).floor().cast<int>();
    cells_[(static_cast<std::size_t>(at.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(at.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(at.x())] = true;
  }
}

bool Occupancy::occupied(const Vec3& point) const {
  const Eigen::Array3i at = ((point.array() - low_) / cell_mm_).floor().cast<int>();
  if ((at < 0).any() || (at >= size_).any()) return false;
  return cells_[(static_cast<std::size_t>(at.z()) * static_cast<std::size_t>(size_.y()) +
                 static_cast<std::size_t>(at.y())) *
                    static_cast<std::size_t>(size_.x()) +
                static_cast<std::size_t>(at.x())];
}

bool Occupancy::hides(const Vec3& place, const Vec3& eye) const {
  if (cells_.empty()) return false;
  const double way_mm = (eye - place).norm();
  const Vec3 direction = (eye - place) / way_mm;
  // Nothing lies beyond the box: no ray need go farther than across it.
  const double end_mm = std::min(way_mm, cell_mm_ * size_.cast<double>().matrix().norm());
  for (double mm = k_own_surface_cells * cell_mm_; mm < end_mm; mm += 0.5 * cell_mm_) {
    if (occupied(place + mm * direction)) return true;
  }
  return false;
}

Check sight_check(const PlannedPath& path, const Sight& sight, const Occupancy& shoe) {
  Check check{.name = "sight",
              .passed = true,
              .value = 0,
              .limit = k_longest_unseen_mm,
              .unit = "mm unseen",
              .arc_mm = -1,
              .detail = ""};
  double unseen_mm = 0;
  for (std::size_t i = 1; i < path.waypoints.size(); ++i) {
    const Waypoint& w = path.waypoints[i];
    const Vec3 camera = w.T_base_tcp * sight.camera_tcp, laser = w.T_base_tcp * sight.laser_tcp;
    const auto hidden_from = [&](const Vec3& eye) {
      return std::ranges::any_of(
          k_heights_mm, [&](double mm) { return shoe.hides(w.line_base + mm * Vec3::UnitZ(), eye); });
    };
    const bool on_line = w.segment == Segment::Line;
    const bool camera_blind = on_line && hidden_from(camera),
               laser_blind = on_line && !camera_blind && hidden_from(laser);
    unseen_mm = camera_blind || laser_blind ? unseen_mm + w.arc_mm - path.waypoints[i - 1].arc_mm : 0;
    if (unseen_mm <= check.value) continue;
    check.value = unseen_mm;
    check.arc_mm = w.arc_mm;
    check.detail =
        camera_blind ? "the shoe stands in the camera's view" : "the shoe stands in the laser's light";
  }
  check.passed = check.value <= check.limit;
  if (check.passed) check.detail.clear();
  return check;
}

}  // namespace biteline::path
