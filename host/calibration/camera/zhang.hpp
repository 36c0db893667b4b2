// SPDX-License-Identifier: MIT
#pragma once
/// \file Closed form of the intrinsics from several views of a plane.

#include <optional>
#include <span>

#include "common/geometry/camera.hpp"

namespace biteline::calibration {

struct PictureSize {
  int width_px{0};
  int height_px{0};
};

/// Zhang 2000, "A flexible new technique for camera calibration", section 3.1 and appendix B with skew 0.
/// Where noise or nearly parallel views leave no positive solution, the principal point is put to the middle
/// and the focal lengths alone are solved.  Nothing when these fail too (all views parallel to the sensor).
[[nodiscard]] std::optional<geometry::Camera> closed_form_camera(std::span<const Mat3> homographies,
                                                                 PictureSize size);

}  // namespace biteline::calibration
