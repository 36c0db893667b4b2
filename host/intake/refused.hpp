// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a scan that came in is not worked on.

#include "host/records/report/refusal.hpp"

namespace biteline::intake {

enum class Refused {
  ScanNotComplete,  ///< it ended before its own end: sensor, poses, light or the link failed
  TestPattern,      ///< the sensor showed made pictures
  CameraState,      ///< the camera's picture is not as its calibration was made: mirrored, turned, binned
  ScanSetAside,     ///< working it out failed before: it must not end the service again and again
  ScanStopped,      ///< a person said stop before it was whole
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

}  // namespace biteline::intake
