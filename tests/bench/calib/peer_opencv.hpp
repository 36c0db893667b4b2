// SPDX-License-Identifier: MIT
#pragma once
/// \file OpenCV's way: findCirclesGrid, calibrateCamera, calibrateHandEye.

#include <optional>
#include <string>
#include <vector>

#include "common/geometry/camera.hpp"
#include "common/image/grey_image.hpp"
#include "host/calibration/camera/zhang.hpp"
#include "host/calibration/handeye/motions.hpp"
#include "host/calibration/rings/target.hpp"

namespace biteline::bench {

/// Centres row by row, numbered from either end; nothing when the grid is not found.  The blob detector looks
/// for dark blobs and finds the rings' middles in the inverted picture.
[[nodiscard]] std::optional<std::vector<Vec2>> opencv_grid(const image::GreyImage& picture,
                                                           const calibration::RingTarget& target);

struct OpencvCamera {
  geometry::Camera camera;
  double rms_px{0};
};
[[nodiscard]] OpencvCamera opencv_camera(const std::vector<std::vector<Vec2>>& views,
                                         const calibration::RingTarget& target,
                                         calibration::PictureSize size);

/// Of a plane target, by solvePnP.
[[nodiscard]] SE3 opencv_pose(const geometry::Camera& camera, const std::vector<Vec2>& centres,
                              const calibration::RingTarget& target);

inline constexpr int k_hand_eye_methods = 5;
[[nodiscard]] const char* hand_eye_name(int method);
[[nodiscard]] SE3 opencv_hand_eye(const std::vector<calibration::Stop>& stops, int method);

}  // namespace biteline::bench
