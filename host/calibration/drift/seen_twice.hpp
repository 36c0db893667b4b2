// SPDX-License-Identifier: MIT
#pragma once
/// \file The part of a scan that was seen more than once, thinned.

#include <vector>

#include "host/calibration/clock/overlap.hpp"
#include "host/calibration/drift/scan_view.hpp"

namespace biteline::drift {

/// Two views of a place are at least so far apart in time: neighbouring profiles are one view.
inline constexpr double k_least_gap_s = 0.3;

struct SeenTwice {
  calibration::Scan times;  ///< frames with their instants only
  std::vector<calibration::ScanPoint> points;
  std::vector<Mat3> rotation;  ///< R_base_flange of each frame
  double reach_mm{2};          ///< neighbours of another view lie within it
};

/// Points about 0.8 mm apart along each stripe, of the cells of space that hold two views.  What is not
/// finite, has no pose or is not before the camera is left out, and so is what an arm that stands sees again.
[[nodiscard]] SeenTwice seen_twice(const ScanView& scan, const geometry::SensorModel& head);

}  // namespace biteline::drift
