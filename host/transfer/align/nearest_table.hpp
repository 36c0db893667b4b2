// SPDX-License-Identifier: MIT
#pragma once
/// \file Nearest surfel in constant time: a table over space, filled outwards from the surface.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host/transfer/align/surfels.hpp"

namespace biteline::transfer {

/// Registration asks for the nearest surfel some hundred thousand times on one target; a table that is filled
/// once answers in one memory access, a kd-tree in some twenty.  The answer is the surfel nearest to the
/// query's cell and so may be a neighbour of the nearest one: the symmetric residual (icp.hpp) does not mind,
/// since it is exact on curved surfaces. Thread: immutable after construction.
class NearestTable {
 public:
  static constexpr std::uint32_t k_none = 0xFFFFFFFF;

  /// Cells are as large as the surfels' pitch (larger where the box would need too many).
  NearestTable(const Surfels& surfels, float reach_mm);

  /// Index of a surfel near `point`, or k_none where the surface is farther than the reach.
  [[nodiscard]] std::uint32_t near(const Eigen::Vector3f& point) const {
    const Eigen::Array3f cell = (point - origin_).array() * per_mm_;
    if (!((cell >= 0.0F).all() && (cell < extent_).all())) return k_none;
    const Eigen::Array3i at = cell.cast<int>();
    return cells_[static_cast<std::size_t>(at.x() + size_.x() * (at.y() + size_.y() * at.z()))];
  }

 private:
  void fill(const Surfels& surfels, float reach_mm);

  Eigen::Vector3f origin_{Eigen::Vector3f::Zero()};
  Eigen::Array3f extent_{Eigen::Array3f::Zero()};
  Eigen::Array3i size_{Eigen::Array3i::Zero()};
  float per_mm_{1};
  std::vector<std::uint32_t> cells_;
};

}  // namespace biteline::transfer
