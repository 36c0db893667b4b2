// SPDX-License-Identifier: MIT
#pragma once
/// \file The parts in order, then everything together: camera, laser plane, mounting.

#include <optional>

#include "host/calibration/head/folder.hpp"
#include "host/calibration/head/refused.hpp"
#include "host/calibration/refine/head_bundle.hpp"
#include "host/calibration/rings/pixel_grid.hpp"

namespace biteline::calibration {

struct HeadInput {
  std::optional<CameraFolder> camera;
  std::optional<LaserFolder> laser;
  std::optional<HandEyeFolder> hand_eye;
  std::optional<geometry::Camera> known_camera;  ///< used, and not changed, when `camera` is not there
  std::optional<PictureSize> known_reach;        ///< of that camera's region: pictures are no smaller
};

/// What came out.  `refused` names the part that gives no trustworthy answer; what was found before it is
/// there.
struct HeadCalibration {
  std::optional<CameraCalibration> camera;
  std::optional<LaserCalibration> laser;
  std::optional<HandEyeCalibration> hand_eye;
  std::vector<ArmPicture> arm_views;  ///< of hand_eye's stops, in their common reading
  HeadFit fit;                        ///< everything together
  PixelGrid pixel_grid;               ///< of the pictures; what was uneven is evened out in all views here
  std::vector<SetAside> set_aside;    ///< of all parts
  std::optional<Error> refused;
  Part refused_in{Part::Camera};        ///< of `refused`
  std::optional<Refused> refused_as{};  ///< where part and kind of error do not say it
};

/// Pre: refused, and with the exit status of a refusal.
[[nodiscard]] Refusal refusal_of(const HeadCalibration& calibration);

/// Each part alone first, which finds what contradicts; then one adjustment of all that is left.
[[nodiscard]] HeadCalibration calibrate_head(const HeadInput& input);

}  // namespace biteline::calibration
