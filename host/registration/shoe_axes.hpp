// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a shoe stands: its own axes, found from its surface alone.

#include "common/geometry/se3.hpp"
#include "host/registration/surfels.hpp"

namespace biteline::registration {

enum class Side { Left, Right, Unclear };

struct ShoeAxes {
  SE3 T_base_shoe{SE3::Identity()};  ///< x heel to toe, y left, z up (base's z); origin at the heel end, lowest point z = 0
  double length_mm{0};
  double width_mm{0};
  Side side{Side::Unclear};
};

/// Heel and toe are told apart by the plan's area, which lies nearer to the toe (the ball of the foot is the widest
/// place); left and right by the midline, which bends towards the big toe.  Good to a few degrees and millimetres: a
/// start for registration, which tries the other readings too.  Pre: at least 3 surfels.
[[nodiscard]] ShoeAxes shoe_axes(const Surfels& surfels);

}  // namespace biteline::registration
