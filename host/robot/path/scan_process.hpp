// SPDX-License-Identifier: MIT
#pragma once
/// \file The scan as a process: the head is the tool, its working point the tip; planned and checked like any
/// other path.

#include "common/geometry/sensor_model.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::path {

struct ScanSettings {
  double rate_hz{90};       ///< profiles per second
  double spacing_mm{1};     ///< between profiles at most: their product is the speed
  double pitch_rad{0.1};    ///< the beam looks down by this much
  double above_line_mm{6};  ///< height of the working point over the line: more of the upper than of the sole
  double emitter_clearance_mm{
      120};  ///< from the working point back to the nearest part of the head along the beam
  double head_radius_mm{45};
  bool turned{false};  ///< the head turned by half about its beam: the camera goes ahead instead of behind
};

/// The working point is where the optical axis meets the laser plane; the beam lies in the plane, across the
/// image columns' direction, so that the stripe stands upright on the wall and the travel is at right angles
/// to the plane. Errc::Degenerate when the optical axis does not meet the plane in front of the camera.
[[nodiscard]] Result<Process> scan_process(const geometry::SensorModel& sensor, const ScanSettings& settings);

}  // namespace biteline::path
