// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a shoe stands: its own axes, found from its surface alone.

#include "common/geometry/se3.hpp"
#include "host/transfer/align/surfels.hpp"

namespace biteline::transfer {

struct ShoeAxes {
  SE3 T_base_shoe{SE3::Identity()};  ///< x heel to toe, y left, z up (base's z); origin at the heel end,
                                     ///< lowest point z = 0
  double length_mm{0};
  double width_mm{0};
};

/// Heel and toe are told apart by the plan's area, which lies nearer to the toe (the ball of the foot is the
/// widest place).  Good to a few degrees and millimetres: a start for registration, which tries the other way
/// round too, and which alone tells left from right (by whether the mirrored sample fits).  Pre: at least 3
/// surfels.
[[nodiscard]] ShoeAxes shoe_axes(const Surfels& surfels);

}  // namespace biteline::transfer
