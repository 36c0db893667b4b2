// SPDX-License-Identifier: MIT
#pragma once
/// \file The largest set of stops that one rotation of the camera on the flange explains, over the grid's
/// readings.

#include <span>
#include <vector>

#include "host/calibration/handeye/hand_eye.hpp"

namespace biteline::calibration {

/// A candidate: pose of the flange and the target's poses in all readings.
struct StopReadings {
  SE3 T_base_flange{SE3::Identity()};
  std::vector<SE3> T_cam_target;
};

struct Consensus {
  std::vector<std::size_t> stops;     ///< indices of those that agree
  std::vector<std::size_t> readings;  ///< of each of them
  Mat3 R_flange_cam{Mat3::Identity()};
  double rms_rad{0};
};

/// Rotations only: free of units, of the target's shifts by whole pitches, and of the translation's noise.
[[nodiscard]] Consensus rotation_consensus(std::span<const StopReadings> stops);

/// A way of having misread the input that would make robot and camera agree; "" when none does.
[[nodiscard]] std::string explain_disagreement(std::span<const StopReadings> stops, std::size_t enough);

}  // namespace biteline::calibration
