// SPDX-License-Identifier: MIT
#pragma once
/// \file Pinhole camera with radial-tangential distortion, as OpenCV defines it.  Pixel centres at whole
/// numbers.

#include "common/geometry/se3.hpp"

namespace biteline::geometry {

/// Intrinsics are for the full sensor; a region of interest shifts pixel coordinates by its offset.
struct Camera {
  double fu_px{0}, fv_px{0}, cu_px{0}, cv_px{0};
  double k1{0}, k2{0}, p1{0}, p2{0}, k3{0};

  /// Distorted normalised coordinates of the ideal ones (x / z, y / z).
  [[nodiscard]] Vec2 distort(const Vec2& ideal) const;

  /// Inverse of distort() by fixed-point steps, then Newton; exact to 1e-12 where distort() is monotonic.
  [[nodiscard]] Vec2 undistort(const Vec2& distorted) const;

  /// Full-sensor pixel of a point in the camera frame.  Pre: z > 0.
  [[nodiscard]] Vec2 project(const Vec3& point_cam) const;

  /// Viewing ray (x, y, 1) of a full-sensor pixel.
  [[nodiscard]] Vec3 ray(const Vec2& pixel_px) const;
};

}  // namespace biteline::geometry
