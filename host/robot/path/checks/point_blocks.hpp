// SPDX-License-Identifier: MIT
#pragma once
/// \file Many points that a capsule may not touch, asked for the nearest one.

#include <cstddef>
#include <vector>

#include "host/robot/kinematics/arm_shape.hpp"

namespace biteline::path {

/// The points in cubes, each with a sphere round what is in it: a capsule passes over a cube whose sphere is
/// far enough.  Exact.  Immutable.
class PointBlocks {
 public:
  explicit PointBlocks(const std::vector<Vec3>& points);

  /// Between the nearest point and the capsule's surface; `enough_mm` where none is nearer than that.
  [[nodiscard]] double nearest_mm(const kinematics::Capsule& capsule, double enough_mm) const;

 private:
  struct Block {
    Vec3 centre;
    double radius_mm;
    std::size_t first, end;  ///< of points_
  };
  std::vector<Vec3> points_;
  std::vector<Block> blocks_;
};

}  // namespace biteline::path
