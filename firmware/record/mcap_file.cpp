// SPDX-License-Identifier: MIT
#include <optional>
#include <utility>

#include "common/config/sensor_yaml.hpp"
#include "common/recording/recording_writer.hpp"
#include "firmware/record/record_store.hpp"
#include "firmware/record/room.hpp"

namespace biteline::record {
namespace {

namespace fs = std::filesystem;

class McapFile final : public RecordStore {
 public:
  McapFile(const StoreConfig& config, recording::RecordingWriter writer)
      : pose_clock_offset_{config.model.pose_clock_offset}, writer_{std::move(writer)} {}

  Result<void> begin(const StoreConfig& config, const session::RecordingFacts& facts) {
    BITELINE_ASSIGN(held_, HeldRecording::hold(config.path));
    BITELINE_TRY(
        writer_.attach("cam0/sensor.yaml", config::sensor_yaml_text(config.model, "as it scanned live")));
    if (!config.settings.empty()) BITELINE_TRY(writer_.attach("settings.yaml", config.settings));
    // Of a file that is cut nothing later is there.
    BITELINE_TRY(writer_.attach("recording.yaml", session::recording_facts_text(facts)));
    BITELINE_TRY(writer_.add_channels());
    return writer_.flush();
  }

  Result<void> add_poses(std::span<const pipeline::RecordedPose> poses) override {
    for (const pipeline::RecordedPose& pose : poses) {
      const std::int64_t camera_ns = pose.stamp.time_since_epoch().count();
      const Vec3& p = pose.translation_mm;
      const Eigen::Quaterniond& q = pose.rotation;
      BITELINE_TRY(noted(writer_.add_pose({.stamp_ns = camera_ns + pose_clock_offset_.count(),
                                           .values = {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()},
                                           .encoder_ticks = pose.encoder_ticks},
                                          camera_ns)));
    }
    return {};
  }

  Result<void> add_message(std::span<const std::uint8_t> message) override {
    BITELINE_ASSIGN(const wire::Message decoded, wire::decode(message));
    return noted(writer_.add_message(decoded, message));
  }

  Result<void> add_picture(const pipeline::RecordedFrame& frame, bool packed) override {
    const std::int64_t stamp_ns = frame.exposure_mid.time_since_epoch().count();
    BITELINE_ASSIGN(const std::span<const std::uint8_t> png, picture_.of(frame, packed));
    return noted(writer_.add_picture({.stamp_ns = stamp_ns,
                                      .file = std::to_string(stamp_ns) + ".png",
                                      .facts = recording::FrameRow::Facts{.sequence = frame.sequence,
                                                                          .flags = frame.flags,
                                                                          .first_row_px = frame.first_row_px,
                                                                          .rows_px = frame.height_px}},
                                     png));
  }

  Result<void> settle() override { return noted(writer_.flush()); }

  /// The facts come behind what they count; a reader takes the last.
  Result<void> finish(const session::RecordingFacts& facts) override {
    if (failed_) return tl::unexpected<Error>{*failed_};
    BITELINE_TRY(noted(writer_.attach("recording.yaml", session::recording_facts_text(facts))));
    const Result<std::string> link = writer_.close();
    return link ? Result<void>{} : tl::unexpected<Error>{link.error()};
  }

 private:
  /// A file into which a piece did not go whole is at its end: everything before it can be read.
  Result<void> noted(Result<void> done) {
    if (!done) failed_ = done.error();
    return done;
  }

  Nanoseconds pose_clock_offset_;
  recording::RecordingWriter writer_;
  std::optional<HeldRecording> held_;
  std::optional<Error> failed_;
  PictureFile picture_;
};

}  // namespace

Result<std::unique_ptr<RecordStore>> open_mcap_file(const StoreConfig& config,
                                                    const session::RecordingFacts& facts) {
  std::error_code error;
  const fs::path parent = config.path.parent_path();
  if (!parent.empty()) fs::create_directories(parent, error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", parent.c_str());
  const std::string who = std::string{k_recorder} + " " + facts.version;
  // Pictures are packed already; profiles are, too.
  BITELINE_ASSIGN(
      recording::RecordingWriter writer,
      recording::RecordingWriter::create(config.path, {.library = who, .build = who, .packed = false}));
  auto file = std::make_unique<McapFile>(config, std::move(writer));
  if (const Result<void> begun = file->begin(config, facts); !begun) {
    file.reset();
    fs::remove(config.path, error);
    return tl::unexpected<Error>{begun.error()};
  }
  return std::unique_ptr<RecordStore>{std::move(file)};
}

}  // namespace biteline::record
