// SPDX-License-Identifier: MIT
#pragma once
/// \file A recorded scan as the calibration needs it: some points of each stripe in pixels, and the robot's
/// poses.

#include <filesystem>
#include <vector>

#include "common/core/result.hpp"
#include "common/session/session.hpp"

namespace biteline::calibration {

struct ScanFrame {
  SensorClock::time_point exposure_mid;
  std::vector<Vec2> stripe_px;  ///< full-sensor pixels
};

struct Scan {
  std::vector<ScanFrame> frames;
  std::vector<session::StampedPose> poses;  ///< robot's clock
  geometry::SensorModel sensor;             ///< as the session tells it
};

/// Reads a session; of each stripe every `column_step`-th sound point.  Pictures are read in parallel.
[[nodiscard]] Result<Scan> read_scan(const std::filesystem::path& session, int column_step);

}  // namespace biteline::calibration
