// SPDX-License-Identifier: MIT
#include "host/records/recording/export.hpp"

#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "common/config/sensor_yaml.hpp"
#include "common/csv/table.hpp"
#include "common/mcap/writer.hpp"
#include "common/recording/layout.hpp"
#include "common/recording/recording_writer.hpp"
#include "common/recording/rows.hpp"
#include "common/session/session.hpp"
#include "common/system/file.hpp"
#include "common/wire/scan_file.hpp"
#include "host/records/recording/ros2.hpp"

namespace biteline::recording {
namespace {

namespace fs = std::filesystem;

mcap::View view(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// A pose, and where its time lies on the camera's clock.
struct TimedPose {
  PoseRow row;
  std::int64_t camera_ns{0};
};

/// As written: read_session() makes rotations of the rows and loses their last digits.
Result<std::vector<TimedPose>> read_poses(const session::Session& session) {
  const fs::path file = session.root / "pose0/data.csv";
  std::vector<TimedPose> poses;
  poses.reserve(session.poses.size());
  BITELINE_TRY(csv::read_table(file, 8, 8, [&](const csv::Row& row) -> Result<void> {
    TimedPose pose;
    BITELINE_ASSIGN(pose.row.stamp_ns, row.integer(0));
    for (std::size_t i = 0; i < pose.row.values.size(); ++i) {
      BITELINE_ASSIGN(pose.row.values.at(i), row.number(i + 1));
    }
    pose.camera_ns = pose.row.stamp_ns - session.sensor.pose_clock_offset.count();
    poses.push_back(pose);
    return {};
  }));
  const fs::path counts_file = session.root / "pose0/encoder.csv";
  std::error_code ignored;
  if (!fs::exists(counts_file, ignored)) return poses;
  std::vector<std::int64_t> stamps_ns;
  for (const TimedPose& pose : poses) stamps_ns.push_back(pose.row.stamp_ns);
  BITELINE_ASSIGN(const auto counts, session::read_encoder_table(counts_file, stamps_ns));
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].row.encoder_ticks = counts[i];
  return poses;
}

/// A recording may have no pictures at all; then its tables are no session's.
Result<session::Session> read_folder(const fs::path& folder) {
  const fs::path facts_file = folder / "recording.yaml";
  std::error_code ignored;
  if (!fs::exists(facts_file, ignored)) return session::read_session(folder);
  BITELINE_ASSIGN(const session::RecordingFacts facts, session::read_recording_facts(facts_file));
  if (facts.pictures > 0) return session::read_session(folder);
  BITELINE_ASSIGN(const geometry::SensorModel sensor, config::read_sensor_yaml(folder / "cam0/sensor.yaml"));
  return session::Session{.root = folder, .sensor = sensor, .frames = {}, .poses = {}, .recorded = facts};
}

class Export {
 public:
  Export(const ExportOptions& options, RecordingWriter writer)
      : options_{options}, writer_{std::move(writer)} {}

  Result<Exported> run() {
    std::error_code ignored;
    const bool folder = fs::is_directory(options_.input, ignored);
    if (folder) {
      BITELINE_ASSIGN(session_, read_folder(options_.input));
      BITELINE_ASSIGN(poses_, read_poses(*session_));
    }
    BITELINE_TRY(attach_files());
    BITELINE_TRY(writer_.add_channels());
    if (options_.ros2) {
      BITELINE_ASSIGN(ros_pose_, writer_.add_cdr_channel(topic::k_ros_pose, ros2::k_pose_schema_name,
                                                         ros2::pose_schema()));
      BITELINE_ASSIGN(ros_points_, writer_.add_cdr_channel(topic::k_ros_points, ros2::k_points_schema_name,
                                                           ros2::points_schema()));
    }
    const fs::path scan = folder ? options_.input / "scan.btln" : options_.input;
    if (!folder || fs::exists(scan, ignored)) {
      BITELINE_TRY(write_scan(scan));
    }
    BITELINE_TRY(write_frames_until(std::numeric_limits<std::int64_t>::max()));
    while (next_pose_ < poses_.size()) {
      BITELINE_TRY(write_next_pose());
    }
    BITELINE_ASSIGN(exported_.last_link, writer_.close());
    return std::move(exported_);
  }

 private:
  Result<void> attach_files() {
    for (const KeptFile& kept : k_kept_files) {
      const bool result = kept.name.starts_with(k_results_prefix);
      if (result ? options_.results.empty() : !session_) continue;
      const fs::path file =
          result ? options_.results / kept.name.substr(k_results_prefix.size()) : options_.input / kept.name;
      std::error_code ignored;
      if (!fs::exists(file, ignored)) continue;
      BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_kept_bytes));
      BITELINE_TRY(writer_.attach(kept.name, text));
      ++exported_.files;
    }
    return {};
  }

  Result<void> write_next_pose() {
    const TimedPose& pose = poses_[next_pose_++];
    ++exported_.poses;
    BITELINE_TRY(writer_.add_pose(pose.row, pose.camera_ns));
    if (!options_.ros2) return {};
    return writer_.add_cdr(ros_pose_, pose.camera_ns, ros2::pose_message(pose.camera_ns, pose.row));
  }

  /// With the pose behind it: where a file is cut, what is left has the poses of its pictures.
  Result<void> write_poses_beyond(std::int64_t time_ns) {
    bool beyond = next_pose_ > 0 && poses_[next_pose_ - 1].camera_ns >= time_ns;
    while (!beyond && next_pose_ < poses_.size()) {
      beyond = poses_[next_pose_].camera_ns >= time_ns;
      BITELINE_TRY(write_next_pose());
    }
    return {};
  }

  Result<void> write_frames_until(std::int64_t time_ns) {
    if (!session_) return {};
    while (next_frame_ < session_->frames.size()) {
      const session::FrameEntry& frame = session_->frames[next_frame_];
      const std::int64_t stamp_ns = frame.exposure_mid.time_since_epoch().count();
      if (stamp_ns > time_ns) return {};
      ++next_frame_;
      BITELINE_TRY(write_poses_beyond(stamp_ns));
      FrameRow row{.stamp_ns = stamp_ns, .file = frame.file.filename().string(), .facts = std::nullopt};
      if (frame.rows_px != 0) {
        row.facts = FrameRow::Facts{.sequence = frame.sequence,
                                    .flags = frame.flags,
                                    .first_row_px = frame.first_row_px,
                                    .rows_px = frame.rows_px};
      }
      BITELINE_ASSIGN(const std::string picture, read_regular_file(frame.file, k_most_kept_bytes));
      BITELINE_TRY(writer_.add_picture(row, view(picture)));
      ++exported_.pictures;
      if (options_.progress) options_.progress(next_frame_, session_->frames.size());
    }
    return {};
  }

  Result<void> write_scan(const fs::path& file) {
    BITELINE_ASSIGN(
        const wire::ScanFileEnd end,
        wire::read_scan_file(
            file, [&](const wire::Message& message, std::span<const std::uint8_t> bytes) -> Result<void> {
              if (const auto* hello = std::get_if<wire::SensorHello>(&message.body))
                T_flange_cam_ = hello->model.T_flange_cam;
              const auto* profile = std::get_if<profile::Profile>(&message.body);
              if (profile != nullptr) {
                BITELINE_TRY(write_frames_until(profile->header.exposure_mid.time_since_epoch().count()));
              }
              ++exported_.messages;
              BITELINE_TRY(writer_.add_message(message, bytes));
              return profile != nullptr ? write_points(*profile) : Result<void>{};
            }));
    BITELINE_TRY(write_frames_until(std::numeric_limits<std::int64_t>::max()));
    if (end.bytes_left != 0) {
      exported_.lacks = file.filename().string() + " is cut or damaged: " + std::to_string(end.bytes_left) +
                        " bytes behind the last whole message are left out";
    }
    return {};
  }

  /// What enters a cloud: profiles and points that are good for it.
  Result<void> write_points(const profile::Profile& profile) {
    const bool usable = (profile.header.flags & profile::k_profile_not_usable) == 0;
    if (!options_.ros2 || !usable || !T_flange_cam_) return {};
    const std::int64_t stamp_ns = profile.header.exposure_mid.time_since_epoch().count();
    return writer_.add_cdr(ros_points_, stamp_ns, ros2::points_message(profile, *T_flange_cam_));
  }

  /// Settings, tables of results, pictures of 16 384 x 16 384 that hold anything.
  static constexpr std::uint64_t k_most_kept_bytes = mcap::k_most_chunk_bytes / 2;

  const ExportOptions& options_;
  RecordingWriter writer_;
  Exported exported_;
  std::optional<session::Session> session_;
  std::vector<TimedPose> poses_;
  std::size_t next_pose_{0}, next_frame_{0};
  std::uint16_t ros_pose_{0}, ros_points_{0};
  std::optional<SE3> T_flange_cam_;  ///< as the scan's hello told it
};

}  // namespace

Result<Exported> export_mcap(const ExportOptions& options) {
  std::error_code error;
  if (fs::exists(options.out, error)) {
    return fail(Errc::WriteFailed, "%s exists; nothing is overwritten", options.out.c_str());
  }
  const fs::path beside = options.out.string() + ".new";
  fs::remove(beside, error);
  BITELINE_ASSIGN(RecordingWriter writer, RecordingWriter::create(beside, {.library = options.library,
                                                                           .build = options.build,
                                                                           .packed = options.packed}));
  Result<Exported> exported = Export{options, std::move(writer)}.run();
  if (exported) {
    fs::rename(beside, options.out, error);
    if (!error) return exported;
    exported = fail_errno(Errc::WriteFailed, error.value(), "%s", options.out.c_str());
  }
  fs::remove(beside, error);
  return exported;
}

}  // namespace biteline::recording
