// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a head gets no calibration: which part, and what kind of trouble.

#include "common/core/error.hpp"
#include "host/report/refusal.hpp"

namespace biteline::calibration {

enum class Part { Camera, Laser, HandEye, Together, Clock };

/// Of each part: its pictures or poses are too few or contradict each other; they do not determine the
/// answer; the search did not settle.
enum class Refused {
  CameraNotTrusted,
  CameraNotDetermined,
  CameraNotConverged,
  LaserNotTrusted,
  LaserNotDetermined,
  LaserNotConverged,
  HandEyeNotTrusted,
  HandEyeNotDetermined,
  HandEyeNotConverged,
  TogetherNotTrusted,
  TogetherNotDetermined,
  TogetherNotConverged,
  ClockNotTrusted,
  ClockNotDetermined,
  ClockNotConverged,
  GradeBad,  ///< it was worked out, and its own figures say that it is not to be used
  // Of the input, before any part is looked at (input_fault.hpp):
  MosaicPictures,     ///< raw, of a colour sensor
  PictureSizes,       ///< the folders' pictures are of different sizes, or smaller than the known camera's
  LaserAlongColumns,  ///< the stripe runs along the pictures' columns
  PosesFrozen,        ///< nearly every pose of the arm is the same one
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

/// Pre: the error's exit status is Refused.
[[nodiscard]] Refusal refusal_of(Part part, const Error& error);

}  // namespace biteline::calibration
