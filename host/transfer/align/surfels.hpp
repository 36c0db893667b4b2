// SPDX-License-Identifier: MIT
#pragma once
/// \file A cloud reduced to evenly spaced surface elements: what registration works on.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace biteline::transfer {

/// Beside a point of a sample, seen from above: the place of its line and the outward normal there.
struct Foot {
  Eigen::Vector2f place{0, 0};
  Eigen::Vector2f outward{0, 0};
};

/// With y turned round.
[[nodiscard]] inline Foot mirrored(const Foot& foot) {
  return {.place = {foot.place.x(), -foot.place.y()}, .outward = {foot.outward.x(), -foot.outward.y()}};
}

/// One element per occupied voxel: mean of its points, normal of the points in the voxel and its 26
/// neighbours.  Evenly dense whatever the scan's spacing was, so that no side of the shoe outweighs another.
struct Surfels {
  std::vector<Eigen::Vector3f> positions{};  ///< mm
  std::vector<Eigen::Vector3f> normals{};    ///< unit length, away from the shoe's middle line
  std::vector<Foot> feet{};                  ///< of a sample only, one each, or empty
  float pitch_mm{0};

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] Foot foot(std::size_t i) const { return feet.empty() ? Foot{} : feet[i]; }
};

/// Voxels whose neighbourhood is no surface (fewer than 8 points, or a blob) are left out.
/// In the order of the voxels (z, then y, then x), so that neighbours on the surface lie near each other in
/// memory, whatever the order of the points.
[[nodiscard]] Surfels surfels_of(std::span<const Eigen::Vector3f> points, float pitch_mm);

/// The same surface at a larger pitch, from its surfels.
[[nodiscard]] Surfels coarsened(const Surfels& fine, float pitch_mm);

}  // namespace biteline::transfer
