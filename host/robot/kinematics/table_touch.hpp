// SPDX-License-Identifier: MIT
#pragma once
/// \file The table's height from touching it at some places with the tool's tip.

#include <span>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"

namespace biteline::kinematics {

struct TableTouch {
  double z_mm{0};                   ///< its height in the robot's base
  double u95_mm{0};                 ///< of it, from the residuals, with 95 %
  double worst_mm{0};               ///< the largest residual
  std::vector<double> residual_mm;  ///< per touch, above the height > 0
};

struct TableTouchLimits {
  double max_residual_mm{1};   ///< paths keep 1 mm above a table that counts as level
  double least_spread_mm{40};  ///< a triangle with sides of 100 mm has 41
};

/// Places of the tip in the robot's base; at least 3.  Errc::Degenerate: they lie too close together or in a
/// row, so they say nothing about a slope.  Errc::CheckFailed: the table is not level, or a touch slipped.
[[nodiscard]] Result<TableTouch> fit_table_touch(std::span<const Vec3> tips_base,
                                                 const TableTouchLimits& limits);

}  // namespace biteline::kinematics
