// SPDX-License-Identifier: MIT
#pragma once
/// \file A recorded scan as a plain folder (README, "Data formats"): reading and writing.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/session/recording_facts.hpp"

namespace biteline::session {

struct FrameEntry {
  SensorClock::time_point exposure_mid;
  std::filesystem::path file;  ///< full path
  // What a live recording tells besides (cam0/frames.csv); a plain session shows whole regions, flagged
  // nothing.
  std::uint64_t sequence{0};  ///< the camera's own count; a plain session's: the row
  std::uint32_t flags{0};     ///< hal::FrameFlag
  int first_row_px{0};        ///< of the region
  int rows_px{0};             ///< the picture's height; 0: all of the region
};

struct StampedPose {
  RobotClock::time_point stamp;
  SE3 T_base_flange{SE3::Identity()};
  std::optional<std::int64_t> encoder_ticks{};  ///< of a live recording, where an encoder is the pose
};

struct Session {
  std::filesystem::path root;
  geometry::SensorModel sensor;
  std::vector<FrameEntry> frames;            ///< stamps strictly rising
  std::vector<StampedPose> poses;            ///< stamps strictly rising, quaternions normalised
  std::optional<RecordingFacts> recorded{};  ///< of a live scan (recording.yaml); none: made or foreign
};

/// Reads everything but the pictures' pixels: sensor.yaml, the tables; every picture named must exist. Fails
/// with file, row and field; refuses poses that do not cover the frames, but for a live recording, where the
/// sensor itself marks such profiles.  Never looks into truth/.
[[nodiscard]] Result<Session> read_session(const std::filesystem::path& root);

/// `#timestamp [ns],p_x [mm],...` rows; also handeye/poses.csv, whose first column is the view's number.
enum class RowOrder {
  Rising,  ///< by stamp; anything else is a fault
  Any,     ///< rows are found by their first column; only one of a kind
};
[[nodiscard]] Result<std::vector<StampedPose>> read_pose_table(const std::filesystem::path& file,
                                                               RowOrder order = RowOrder::Rising);

/// pose0/encoder.csv: the count at each of the poses of these stamps, in their order; nothing at a pose
/// without a row.  Rows behind the last pose are passed over: a recording that was cut may have them.
[[nodiscard]] Result<std::vector<std::optional<std::int64_t>>> read_encoder_table(
    const std::filesystem::path& file, std::span<const std::int64_t> pose_stamps_ns);

[[nodiscard]] Result<void> write_pose_table(const std::filesystem::path& file,
                                            const std::vector<StampedPose>& poses);
/// One row with every digit of the numbers: what is read back makes the same pose, bit for bit.
/// `pose_clock_offset`: robot clock minus sensor clock, as in the session's sensor.yaml.
[[nodiscard]] std::string exact_pose_row(SensorClock::time_point stamp, Nanoseconds pose_clock_offset,
                                         const Eigen::Quaterniond& rotation, const Vec3& translation_mm);
inline constexpr const char* k_pose_table_head =
    "#timestamp [ns],p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z []\n";
inline constexpr const char* k_encoder_table_head = "#timestamp [ns],encoder [ticks]\n";
inline constexpr const char* k_frame_table_head = "#timestamp [ns],filename\n";
/// cam0/frames.csv, one row for each of cam0/data.csv.
inline constexpr const char* k_frame_facts_head =
    "#timestamp [ns],sequence [],flags [],first_row [px],rows [px]\n";
[[nodiscard]] Result<void> write_frame_table(const std::filesystem::path& file,
                                             const std::vector<FrameEntry>& frames);

}  // namespace biteline::session
