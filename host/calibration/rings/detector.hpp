// SPDX-License-Identifier: MIT
#pragma once
/// \file Finds rings in a picture: both edges, sub-pixel.

#include <vector>

#include "common/image/grey_image.hpp"
#include "host/calibration/rings/ellipse.hpp"

namespace biteline::calibration {

/// One ring in a picture, in full-sensor pixels.  Of a chessboard's corner only centre and blur are set.
struct Ring {
  Ellipse outer, inner;                      ///< fitted to the edges below
  std::vector<Vec2> outer_edge, inner_edge;  ///< kept edge points
  Vec2 centre_px{Vec2::Zero()};              ///< image of the circles' centre, from the pair
  double diameter_ratio{0};                  ///< inner to outer
  double edge_rms_px{0};                     ///< of both fits
  double blur_px{0};                         ///< of a corner: standard deviation, across its blurrier edge
};

/// Every whole, dark, closed ring; several scales of the threshold, so that size and light may be anything.
/// A ring that is cut, covered or washed out is not found; it costs nothing else.
/// None at all where there are more than `most`: noise and patterns are full of spots that pass for rings,
/// and a picture of a target is not.
inline constexpr std::size_t k_most_rings = 4000;
[[nodiscard]] std::vector<Ring> find_rings(const image::GreyImage& picture, std::size_t most = k_most_rings);

/// The ring whose edges lie near two ellipses, where at least 60 % of each edge can be seen.
[[nodiscard]] std::optional<Ring> refine_ring(const image::GreyImage& picture, const Ellipse& outer,
                                              const Ellipse& inner);

}  // namespace biteline::calibration
