// SPDX-License-Identifier: MIT
#include "host/records/recording/export.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "common/config/sensor_yaml.hpp"
#include "common/csv/table.hpp"
#include "common/mcap/writer.hpp"
#include "common/session/session.hpp"
#include "common/system/file.hpp"
#include "common/wire/binary_schema.hpp"
#include "common/wire/scan_file.hpp"
#include "host/records/recording/layout.hpp"
#include "host/records/recording/picture.hpp"
#include "host/records/recording/rows.hpp"

namespace biteline::recording {
namespace {

namespace fs = std::filesystem;

mcap::View view(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Times of an MCAP file have no sign; the exact stamps are in the messages.
std::uint64_t log_time(std::int64_t stamp_ns) {
  return stamp_ns < 0 ? 0 : static_cast<std::uint64_t>(stamp_ns);
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
  Export(const ExportOptions& options, mcap::Writer writer) : options_{options}, writer_{std::move(writer)} {}

  Result<Exported> run() {
    std::error_code ignored;
    const bool folder = fs::is_directory(options_.input, ignored);
    if (folder) {
      BITELINE_ASSIGN(session_, read_folder(options_.input));
      BITELINE_ASSIGN(poses_, read_poses(*session_));
    }
    BITELINE_TRY(writer_.add_metadata({.name = "biteline.build", .values = {{"program", options_.build}}}));
    BITELINE_TRY(attach_files());
    BITELINE_TRY(add_channels());
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
      BITELINE_TRY(writer_.attach({.log_time_ns = 0,
                                   .create_time_ns = 0,
                                   .name = std::string{kept.name},
                                   .media_type = std::string{kept.media_type},
                                   .data = view(text),
                                   .crc = 0}));
      ++exported_.files;
    }
    return {};
  }

  Result<void> add_channels() {
    const auto add = [&](const char* topic, const char* encoding, std::string name,
                         const char* schema_encoding, std::string schema) -> Result<std::uint16_t> {
      BITELINE_ASSIGN(const std::uint16_t id,
                      writer_.add_schema(std::move(name), schema_encoding, std::move(schema)));
      return writer_.add_channel(id, topic, encoding);
    };
    BITELINE_ASSIGN(pose_, add(topic::k_pose, "json", "biteline.Pose", "jsonschema", k_pose_schema));
    BITELINE_ASSIGN(frame_, add(topic::k_frame, "json", "biteline.Frame", "jsonschema", k_frame_schema));
    BITELINE_ASSIGN(picture_,
                    add(topic::k_picture, "cdr", k_picture_schema_name, "ros2msg", k_picture_schema));
    const auto wire_schema = wire::binary_schema();
    BITELINE_ASSIGN(scan_, add(topic::k_scan, "flatbuffer", "biteline.wire.fb.Envelope", "flatbuffer",
                               std::string{wire_schema.begin(), wire_schema.end()}));
    BITELINE_ASSIGN(event_, add(topic::k_event, "json", "biteline.Event", "jsonschema", k_event_schema));
    return {};
  }

  Result<void> write(std::uint16_t channel, std::int64_t time_ns, mcap::View data) {
    now_ns_ = time_ns;
    return writer_.write({.channel_id = channel,
                          .sequence = counts_[channel]++,
                          .log_time_ns = log_time(time_ns),
                          .publish_time_ns = log_time(time_ns),
                          .data = data});
  }

  Result<void> write_next_pose() {
    const TimedPose& pose = poses_[next_pose_++];
    ++exported_.poses;
    return write(pose_, pose.camera_ns, view(message_of(pose.row)));
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
      BITELINE_TRY(write(frame_, stamp_ns, view(message_of(row))));
      BITELINE_TRY(write(picture_, stamp_ns, picture_message(stamp_ns, view(picture))));
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
              if (const auto* profile = std::get_if<profile::Profile>(&message.body)) {
                const std::int64_t time_ns = profile->header.exposure_mid.time_since_epoch().count();
                BITELINE_TRY(write_frames_until(time_ns));
                now_ns_ = time_ns;
                BITELINE_TRY(write_early());
                ++exported_.messages;
                return write(scan_, time_ns, bytes);
              }
              // The hello has no time of its own; it is written with what comes next, before it.
              if (exported_.messages == 0 && early_.size() < k_most_early) {
                early_.push_back({message, {bytes.begin(), bytes.end()}});
                return {};
              }
              return write_told(message, bytes);
            }));
    BITELINE_TRY(write_frames_until(std::numeric_limits<std::int64_t>::max()));
    BITELINE_TRY(write_early());
    if (end.bytes_left != 0) {
      exported_.lacks = file.filename().string() + " is cut or damaged: " + std::to_string(end.bytes_left) +
                        " bytes behind the last whole message are left out";
    }
    return {};
  }

  Result<void> write_early() {
    for (const auto& [message, bytes] : std::exchange(early_, {})) {
      BITELINE_TRY(write_told(message, bytes));
    }
    return {};
  }

  /// What is no profile, and what it says for people.
  Result<void> write_told(const wire::Message& message, std::span<const std::uint8_t> bytes) {
    using Json = nlohmann::ordered_json;
    ++exported_.messages;
    BITELINE_TRY(write(scan_, now_ns_, bytes));
    Json event;
    if (const auto* hello = std::get_if<wire::SensorHello>(&message.body)) {
      event = {{"event", "begin"},
               {"scan_id", message.scan_id},
               {"sensor", hello->name},
               {"version", hello->version}};
    } else if (const auto* end = std::get_if<wire::EndOfScan>(&message.body)) {
      event = {{"event", "end"},
               {"scan_id", message.scan_id},
               {"complete", end->errc == 0},
               {"where", end->where},
               {"frames", end->counters.frames},
               {"frames_lost", end->counters.frames_lost},
               {"profiles", end->counters.profiles},
               {"profiles_dropped", end->counters.profiles_dropped}};
    } else {
      return {};
    }
    return write(event_, now_ns_, view(event.dump(-1, ' ', false, Json::error_handler_t::replace)));
  }

  /// Settings, tables of results, pictures of 16 384 x 16 384 that hold anything.
  static constexpr std::uint64_t k_most_kept_bytes = mcap::k_most_chunk_bytes / 2;
  static constexpr std::size_t k_most_early = 100;

  const ExportOptions& options_;
  mcap::Writer writer_;
  Exported exported_;
  std::optional<session::Session> session_;
  std::vector<TimedPose> poses_;
  std::size_t next_pose_{0}, next_frame_{0};
  std::int64_t now_ns_{0};
  std::uint16_t pose_{0}, frame_{0}, picture_{0}, scan_{0}, event_{0};
  std::map<std::uint16_t, std::uint32_t> counts_;
  std::vector<std::pair<wire::Message, wire::Bytes>> early_;
};

}  // namespace

Result<Exported> export_mcap(const ExportOptions& options) {
  std::error_code error;
  if (fs::exists(options.out, error)) {
    return fail(Errc::WriteFailed, "%s exists; nothing is overwritten", options.out.c_str());
  }
  const fs::path beside = options.out.string() + ".new";
  fs::remove(beside, error);
  BITELINE_ASSIGN(mcap::Writer writer,
                  mcap::Writer::create(beside, {.library = options.library,
                                                .compression = options.packed ? mcap::Compression::Zstd
                                                                              : mcap::Compression::None}));
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
