// SPDX-License-Identifier: MIT
#pragma once
/// \file Plane to picture: the homography from point pairs.

#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"

namespace biteline::calibration {

struct PlanePoint {
  Vec2 plane;  ///< in the target's plane
  Vec2 image;
};

/// Direct linear transformation with normalised coordinates (Hartley and Zisserman, algorithm 4.2), then
/// Gauss-Newton on the distances in the image.  Nothing for fewer than 4 points or for points on a line.
[[nodiscard]] std::optional<Mat3> fit_homography(std::span<const PlanePoint> points);

[[nodiscard]] Vec2 apply_homography(const Mat3& H, const Vec2& plane);

/// Determinant of the local map's Jacobian: negative where the picture is a mirror image of the plane.
[[nodiscard]] double homography_orientation(const Mat3& H, const Vec2& plane);

}  // namespace biteline::calibration
