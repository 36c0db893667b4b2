// SPDX-License-Identifier: MIT
#pragma once
/// \file Corners where two dark and two bright squares meet, sub-pixel.

#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/image/grey_image.hpp"

namespace biteline::calibration {

/// A saddle of grey: two edges that cross.  Between `edge_a` and `edge_b` it is bright where `contrast` > 0.
struct Corner {
  Vec2 place_px{Vec2::Zero()};
  Vec2 edge_a{Vec2::UnitX()}, edge_b{Vec2::UnitY()};  ///< unit directions, b less than half a turn after a
  double mean_grey{0}, contrast{0};                   ///< grey = mean +- contrast in the squares
  double blur_a_px{1}, blur_b_px{1};                  ///< standard deviation across each edge

  /// Whether the square in this direction is bright.
  [[nodiscard]] bool bright_towards(const Vec2& direction) const;
};

/// All of a picture, on three scales, so that squares may have 12 px or half of the picture.
[[nodiscard]] std::vector<Corner> find_corners(const image::GreyImage& picture);

/// Least squares of a whole corner over the pixels within `radius_px`: place, both edges' directions and
/// blurs, both greys, and the light's slope.  The crossing of two straight edges stays it under any
/// perspective, and blur is the same on all sides: there is nothing to correct, other than of a circle's
/// centre.  Nothing where it is no corner, or not within `reach_px`.
[[nodiscard]] std::optional<Corner> refine_corner(const image::GreyImage& picture, const Corner& near,
                                                  double radius_px, double reach_px);

}  // namespace biteline::calibration
