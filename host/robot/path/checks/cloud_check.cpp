// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/cloud_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "common/core/numbers.hpp"

namespace biteline::path {
namespace {

// A found line lies on its points within their noise and half their spacing, a carried one on their surface.
constexpr double k_on_surface_mm = 2;
// A carried line bridges gaps; more of it than this in the air is no line of this cloud.
constexpr double k_most_away_ratio = 0.05;
constexpr double k_cell_mm = k_on_surface_mm;

using Key = std::uint64_t;

Key key_of(const Eigen::Array3i& cell) {
  // 21 bits an axis; places are below 100 m.
  const auto bits = [](int i) { return static_cast<Key>(i + (1 << 20)) & 0x1FFFFFU; };
  return bits(cell.x()) | bits(cell.y()) << 21U | bits(cell.z()) << 42U;
}

Eigen::Array3i cell_of(const Vec3& place) {
  return (place.array() / k_cell_mm).floor().cast<int>();
}

/// The line's points by the cells they lie in and beside.
std::unordered_map<Key, std::vector<std::uint32_t>> cells_beside(const cloud::ClosedLine& line) {
  std::unordered_map<Key, std::vector<std::uint32_t>> cells;
  for (std::uint32_t i = 0; i < line.points.size(); ++i) {
    const Eigen::Array3i middle = cell_of(line.points[i].position);
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dz = -1; dz <= 1; ++dz) cells[key_of(middle + Eigen::Array3i{dx, dy, dz})].push_back(i);
      }
    }
  }
  return cells;
}

}  // namespace

Check check_on_cloud(const cloud::ClosedLine& line, const std::vector<Eigen::Vector3f>& cloud) {
  const auto cells = cells_beside(line);
  Eigen::AlignedBox3d box;
  for (const cloud::LinePoint& p : line.points) box.extend(p.position);
  box.min().array() -= k_on_surface_mm;
  box.max().array() += k_on_surface_mm;
  std::vector<char> on_surface(line.points.size(), 0);
  for (const Eigen::Vector3f& point : cloud) {
    const Vec3 place = point.cast<double>();
    if (!is_plausible_place(place) || !box.contains(place)) continue;
    const auto found = cells.find(key_of(cell_of(place)));
    if (found == cells.end()) continue;
    for (const std::uint32_t i : found->second) {
      if ((line.points[i].position - place).squaredNorm() <= k_on_surface_mm * k_on_surface_mm)
        on_surface[i] = 1;
    }
  }
  const auto away = std::ranges::count(on_surface, 0);
  const double ratio =
      static_cast<double>(away) / static_cast<double>(std::max<std::size_t>(1, line.points.size()));
  Check check{.name = "on the cloud",
              .passed = !line.points.empty() && ratio <= k_most_away_ratio,
              .value = ratio,
              .limit = k_most_away_ratio,
              .unit = "of the line",
              .arc_mm = -1,
              .detail = {}};
  if (!check.passed)
    check.detail = "the line leaves the surface of the cloud by more than 2 mm: not of this scan";
  return check;
}

}  // namespace biteline::path
