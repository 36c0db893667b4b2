// SPDX-License-Identifier: MIT
#pragma once
/// \file A recorded scan as a plain folder (README, "Data formats"): reading and writing.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"

namespace biteline::session {

struct FrameEntry {
  SensorClock::time_point exposure_mid;
  std::filesystem::path file;  ///< full path
};

struct StampedPose {
  RobotClock::time_point stamp;
  SE3 T_base_flange{SE3::Identity()};
};

struct Session {
  std::filesystem::path root;
  geometry::SensorModel sensor;
  std::vector<FrameEntry> frames;  ///< stamps strictly rising
  std::vector<StampedPose> poses;  ///< stamps strictly rising, quaternions normalised
};

/// Reads everything but the pictures' pixels: sensor.yaml, both tables; every picture named must exist. Fails
/// with file, row and field; refuses poses that do not cover the frames.  Never looks into truth/.
[[nodiscard]] Result<Session> read_session(const std::filesystem::path& root);

/// `#timestamp [ns],p_x [mm],...` rows; also handeye/poses.csv, whose first column is the view's number.
enum class RowOrder {
  Rising,  ///< by stamp; anything else is a fault
  Any,     ///< rows are found by their first column; only one of a kind
};
[[nodiscard]] Result<std::vector<StampedPose>> read_pose_table(const std::filesystem::path& file,
                                                               RowOrder order = RowOrder::Rising);

[[nodiscard]] Result<void> write_pose_table(const std::filesystem::path& file,
                                            const std::vector<StampedPose>& poses);
[[nodiscard]] Result<void> write_frame_table(const std::filesystem::path& file,
                                             const std::vector<FrameEntry>& frames);

}  // namespace biteline::session
