// SPDX-License-Identifier: MIT
#include <cerrno>
#include <optional>
#include <utility>

#include "common/config/sensor_yaml.hpp"
#include "common/session/session.hpp"
#include "common/wire/scan_file.hpp"
#include "firmware/record/append_file.hpp"
#include "firmware/record/record_store.hpp"
#include "firmware/record/room.hpp"

namespace biteline::record {
namespace {

namespace fs = std::filesystem;

Result<void> make_folders(const fs::path& folder) {
  std::error_code error;
  const fs::path parent = folder.parent_path();
  if (!parent.empty()) fs::create_directories(parent, error);
  if (error || !fs::create_directory(folder, error)) {
    return fail_errno(Errc::WriteFailed, error ? error.value() : EEXIST, "%s", folder.c_str());
  }
  fs::create_directories(folder / "cam0/data", error);
  if (!error) fs::create_directory(folder / "pose0", error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", folder.c_str());
  return {};
}

Result<AppendFile> create_with(const fs::path& file, std::string_view head) {
  BITELINE_ASSIGN(AppendFile created, AppendFile::create(file));
  BITELINE_TRY(created.append(head));
  return created;
}

Result<void> write_whole(const fs::path& file, std::span<const std::uint8_t> bytes) {
  BITELINE_ASSIGN(AppendFile created, AppendFile::create(file));
  return created.append(bytes);
}

class SessionFolder final : public RecordStore {
 public:
  explicit SessionFolder(const StoreConfig& config)
      : folder_{config.path}, pose_clock_offset_{config.model.pose_clock_offset} {}

  Result<void> open(const StoreConfig& config, const session::RecordingFacts& facts) {
    BITELINE_TRY(make_folders(folder_));
    BITELINE_ASSIGN(held_, HeldRecording::hold(folder_));
    BITELINE_ASSIGN([[maybe_unused]] const AppendFile head,
                    create_with(folder_ / "cam0/sensor.yaml",
                                config::sensor_yaml_text(config.model, "as it scanned live")));
    if (!config.settings.empty()) {
      BITELINE_ASSIGN([[maybe_unused]] const AppendFile settings,
                      create_with(folder_ / "settings.yaml", config.settings));
    }
    BITELINE_ASSIGN(frames_, create_with(folder_ / "cam0/data.csv", session::k_frame_table_head));
    BITELINE_ASSIGN(frame_facts_, create_with(folder_ / "cam0/frames.csv", session::k_frame_facts_head));
    BITELINE_ASSIGN(poses_, create_with(folder_ / "pose0/data.csv", session::k_pose_table_head));
    BITELINE_ASSIGN(scan_, create_with(folder_ / "scan.btln", wire::k_scan_file_magic));
    return finish(facts);
  }

  Result<void> add_poses(std::span<const pipeline::RecordedPose> poses) override {
    std::string rows, counts;
    for (const pipeline::RecordedPose& pose : poses) {
      rows += session::exact_pose_row(pose.stamp, pose_clock_offset_, pose.rotation, pose.translation_mm);
      if (!pose.encoder_ticks) continue;
      counts += std::to_string((pose.stamp.time_since_epoch() + pose_clock_offset_).count()) + ',' +
                std::to_string(*pose.encoder_ticks) + '\n';
    }
    // The counts first: a cut between the two leaves rows too many, which a reader passes over.
    if (!counts.empty()) {
      if (!counts_) {
        BITELINE_ASSIGN(counts_, create_with(folder_ / "pose0/encoder.csv", session::k_encoder_table_head));
      }
      BITELINE_TRY(counts_->append(counts));
    }
    return poses_->append(rows);
  }

  Result<void> add_message(std::span<const std::uint8_t> message) override {
    wire::make_scan_record(message, record_);
    return scan_->append(record_);
  }

  Result<void> add_picture(const pipeline::RecordedFrame& frame, bool packed) override {
    const std::string stamp = std::to_string(frame.exposure_mid.time_since_epoch().count());
    const fs::path file = folder_ / "cam0/data" / (stamp + ".png");
    BITELINE_ASSIGN(const std::span<const std::uint8_t> png, picture_.of(frame, packed));
    Result<void> written = write_whole(file, png);
    // The facts first: a cut between the two leaves a row too many, which a reader passes over.
    if (written) {
      written = frame_facts_->append(stamp + ',' + std::to_string(frame.sequence) + ',' +
                                     std::to_string(frame.flags) + ',' + std::to_string(frame.first_row_px) +
                                     ',' + std::to_string(frame.height_px) + '\n');
    }
    if (written) written = frames_->append(stamp + ',' + stamp + ".png\n");
    std::error_code ignored;
    if (!written) fs::remove(file, ignored);
    return written;
  }

  Result<void> finish(const session::RecordingFacts& facts) override {
    const fs::path file = folder_ / "recording.yaml", beside = folder_ / "recording.yaml.new";
    std::error_code error;
    fs::remove(beside, error);
    {
      BITELINE_ASSIGN([[maybe_unused]] const AppendFile written,
                      create_with(beside, session::recording_facts_text(facts)));
    }
    fs::rename(beside, file, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", file.c_str());
    return {};
  }

 private:
  fs::path folder_;
  Nanoseconds pose_clock_offset_;
  std::optional<HeldRecording> held_;
  std::optional<AppendFile> frames_, frame_facts_, poses_, scan_;
  std::optional<AppendFile> counts_;  ///< once a pose has an encoder's count
  PictureFile picture_;
  wire::Bytes record_;
};

}  // namespace

Result<std::unique_ptr<RecordStore>> open_session_folder(const StoreConfig& config,
                                                         const session::RecordingFacts& facts) {
  auto folder = std::make_unique<SessionFolder>(config);
  BITELINE_TRY(folder->open(config, facts));
  return std::unique_ptr<RecordStore>{std::move(folder)};
}

}  // namespace biteline::record
