// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a scan that came in is not worked on.

#include "host/report/refusal.hpp"

namespace biteline::intake {

enum class Refused {
  ScanNotComplete,   ///< it ended before its own end: sensor, poses, light or the link failed
  TestPattern,       ///< the sensor showed made pictures
  CameraState,       ///< the camera's picture is not as its calibration was made: mirrored, turned, binned
  StoppedByAPerson,  ///< on its way: what there is of it is no shoe to be judged
  ScanSetAside,      ///< working it out failed before: it must not end the service again and again
  // Of a scan that came to its end, and in which no line was found (scan_cause.hpp):
  NoPoses,             ///< profiles without any pose
  PosesTooFar,         ///< poses came, and not near enough to the exposures
  ClockUnsure,         ///< when the pictures were taken is not known well enough
  TriggerMismatch,     ///< pictures and the trigger's edges do not pair
  FramesDamaged,       ///< the driver gave broken pictures
  NoTime,              ///< sensor or host did not keep up: profiles came late, or were dropped
  FramesLost,          ///< pictures did not come from the camera
  NoStripe,            ///< hardly a profile shows the laser's stripe
  StripeAlongColumns,  ///< the stripe runs along the columns, and so hardly a column meets it once
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

}  // namespace biteline::intake
