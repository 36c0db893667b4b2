// SPDX-License-Identifier: MIT
#pragma once
/// \file Sub-pixel edge points along an ellipse.

#include <vector>

#include "common/image/grey_image.hpp"
#include "host/calibration/rings/ellipse.hpp"

namespace biteline::calibration {

struct EdgeSearch {
  double reach_px{3};        ///< looked at on either side of the ellipse
  bool dark_outside{false};  ///< the ring's inner edge: dark outside; its outer edge: bright outside
};

/// Where the grey level crosses half way between both sides' levels, along the ellipse's normals, one point
/// per pixel of circumference (72 at least).  Half way is where a step blurred by any symmetric kernel has
/// its edge, in light that falls off over the ring too: each side's slope is taken off.  Places without a
/// clear step (cover, the picture's border) give no point, nor do those whose bright side glare has cut,
/// unless the rest of the edge is too little.
[[nodiscard]] std::vector<Vec2> edge_points(const image::GreyImage& picture, const Ellipse& ellipse,
                                            EdgeSearch search);

}  // namespace biteline::calibration
