// SPDX-License-Identifier: MIT
#pragma once
/// \file How much a profile bends at each of its points, for the live view.

#include <span>
#include <vector>

#include "common/profile/profile.hpp"

namespace biteline::web {

/// 1/mm, concave above 0 as a bite line is: of the circle through the point and those `reach_mm` before and
/// behind it in the laser plane (Menger's curvature).  NaN at the ends, beside gaps and where the point is no
/// surface. A picture for people: the line is found on the whole surface, not on this.
[[nodiscard]] std::vector<float> profile_curvature(std::span<const profile::ProfilePoint> points,
                                                   float reach_mm = 2.0F);

}  // namespace biteline::web
