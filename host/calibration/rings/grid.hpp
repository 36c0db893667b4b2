// SPDX-License-Identifier: MIT
#pragma once
/// \file Which ring is which: rings of a picture sorted into the rows and columns of one or more grids.

#include <vector>

#include "host/calibration/rings/detector.hpp"
#include "host/calibration/rings/target.hpp"

namespace biteline::calibration {

/// A ring with its place on the target.  A plain grid looks the same from more than one side, so the place is
/// one of several equally good readings (GridView::readings).
struct GridRing {
  Ring ring;
  int row{0};
  int col{0};
};

/// How another reading of the same picture would number the rings: its target frame in this reading's,
/// p_this = T_this_other * p_other.  A whole number of quarter turns about the plane's normal and of pitches.
struct Reading {
  SE3 T_this_other{SE3::Identity()};
};

/// One grid in one picture.
struct GridView {
  std::vector<GridRing> rings;    ///< by row, then column
  int missing{0};                 ///< rings of the target that were not found
  std::vector<Reading> readings;  ///< all, this one (identity) first: 2 for a whole grid, 4 for a square one,
                                  ///< more when a whole outer row or column is missing
};

/// Up to `count` grids of `target` among the rings of one picture, best first.
///
/// A cell of four neighbours gives a first homography; it grows ring by ring, each predicted from those
/// around it and checked by place and by size, so that rings of another plane, print or shadow do not join.
/// Works under any rotation and tilt, and with rings missing; the published rule (smallest ellipses are the
/// farthest row) needs a tilt and every ring. Of a grid at least `k_least_grid_rings` and 40 % of the rings
/// must be there.
[[nodiscard]] std::vector<GridView> find_grids(const std::vector<Ring>& rings, const RingTarget& target,
                                               int count);

inline constexpr int k_least_grid_rings = 6;

/// find_rings() and find_grids(), and a second look where a ring of a found grid is missing.
[[nodiscard]] std::vector<GridView> find_grids(const image::GreyImage& picture, const RingTarget& target,
                                               int count);

}  // namespace biteline::calibration
