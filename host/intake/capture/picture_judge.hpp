// SPDX-License-Identifier: MIT
#pragma once
/// \file Is a calibration picture worth keeping?  Told at once, while the arm still stands there.

#include <string>
#include <vector>

#include "common/image/grey_image.hpp"
#include "host/calibration/rings/grid.hpp"

namespace biteline::capture {

struct PictureVerdict {
  std::string refused;                ///< why it is not kept; empty: it is
  std::vector<std::string> warnings;  ///< kept, but could be better
  int rings{0};
  double blur_px{0};  ///< standard deviation of the edges' blur, in the worse direction
};

/// Lamp on.  `grids`: what find_grids() gave, `target.planes` of them expected.
[[nodiscard]] PictureVerdict judge_rings(const image::GreyImage& picture,
                                         const std::vector<calibration::GridView>& grids,
                                         const calibration::RingTarget& target);

/// Laser on, lamp filtered out.
[[nodiscard]] PictureVerdict judge_stripe(const image::GreyImage& picture);

}  // namespace biteline::capture
