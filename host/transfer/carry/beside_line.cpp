// SPDX-License-Identifier: MIT
#include "host/transfer/carry/beside_line.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "host/transfer/align/voxel_map.hpp"

namespace biteline::transfer {
namespace {

constexpr float k_voxel_mm = 8;  // those about a marked one reach as far: past a point surface's radius
constexpr double k_step_mm = 4;  // of marks along a ray and along the line: none of the voxels is skipped
// A normal's ray begins where the line's ray has met the surface, and goes half as far.
constexpr double k_reaches = 1.5;

void mark_about(VoxelKey key, VoxelMap& marked) {
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) marked.number(VoxelGrid::neighbour(key, dx, dy, dz));
    }
  }
}

VoxelMap marked_voxels(const VoxelGrid& grid, const std::vector<PlacedPoint>& placed,
                       const CarryOptions& options) {
  VoxelMap met;
  const double reach_mm = k_reaches * options.reach_mm;
  const std::array heights_mm{0.0, options.normal_high_mm / 2, options.normal_high_mm};
  Vec3 last = placed.front().position;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Vec3& here = placed[i].position;
    const Vec3& next = placed[(i + 1) % placed.size()].position;
    if (i > 0 && (next - last).norm() < k_step_mm) continue;
    last = here;
    const Vec3 direction = ray_direction(placed[i], options);
    for (const double height_mm : heights_mm) {
      for (double away_mm = -reach_mm; away_mm <= reach_mm; away_mm += k_step_mm)
        met.number(grid.key((here + height_mm * options.up + away_mm * direction).cast<float>()));
    }
  }
  VoxelMap marked;
  for (const VoxelKey key : met.keys()) mark_about(key, marked);
  return marked;
}

}  // namespace

std::vector<Eigen::Vector3f> points_beside(std::span<const Eigen::Vector3f> points,
                                           const std::vector<PlacedPoint>& placed,
                                           const CarryOptions& options) {
  const VoxelGrid grid{k_voxel_mm};
  const VoxelMap marked = marked_voxels(grid, placed, options);
  std::vector<std::uint8_t> beside(points.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, points.size(), 4096}, [&](const auto& range) {
    // Points come in the order of the scan: mostly in the voxel of the last one.
    VoxelKey last = 0;
    bool in_last = marked.find(last) >= 0;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const VoxelKey key = grid.key(points[i]);
      if (key != last) in_last = marked.find(key) >= 0;
      last = key;
      beside[i] = in_last ? 1 : 0;
    }
  });
  std::vector<Eigen::Vector3f> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (beside[i] != 0) kept.push_back(points[i]);
  }
  return kept;
}

}  // namespace biteline::transfer
