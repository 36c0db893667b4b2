// SPDX-License-Identifier: MIT
#pragma once
/// \file Which points are the shoe, and where its own axes lie.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/geometry/se3.hpp"
#include "host/bite_line/pooled_vector.hpp"
#include "host/bite_line/refused.hpp"

namespace biteline::bite_line {

struct Shoe {
  SE3 T_base_shoe{
      SE3::Identity()};  ///< x heel to toe, y left, z up; origin at the heel, z = 0 at the lowest point seen
  PooledVector<Eigen::Vector3f> points;  ///< in shoe, in the order of the cloud
  PooledVector<std::uint32_t> index;     ///< of each point, in the cloud
  PooledVector<std::uint8_t> alone;      ///< per point: hardly another one near, a stray or an edge
  Eigen::AlignedBox3f box;               ///< of these points
  double length_mm{0};
  double width_mm{0};
};

/// Leaves out a table plane, outliers and what stands apart from the shoe, then finds the axes.
///
/// Up is base z to within 12 degrees; the table, or else the rim of the sole, gives it better.  Toe and heel
/// are told apart by the plan's area, which lies towards the wider forefoot.  Memory: 25 bytes per point.
[[nodiscard]] OrRefusal<Shoe> find_shoe(std::span<const Eigen::Vector3f> points_base);

}  // namespace biteline::bite_line
