// SPDX-License-Identifier: MIT
#include "common/recording/recording_writer.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/core/contracts.hpp"
#include "common/recording/layout.hpp"
#include "common/recording/picture.hpp"
#include "common/wire/binary_schema.hpp"

namespace biteline::recording {
namespace {

mcap::View view(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Times of an MCAP file have no sign; the exact stamps are in the messages.
std::uint64_t log_time(std::int64_t stamp_ns) {
  return stamp_ns < 0 ? 0 : static_cast<std::uint64_t>(stamp_ns);
}

}  // namespace

Result<RecordingWriter> RecordingWriter::create(const std::filesystem::path& file, Options options) {
  BITELINE_ASSIGN(mcap::Writer writer,
                  mcap::Writer::create(file, {.library = std::move(options.library),
                                              .compression = options.packed ? mcap::Compression::Zstd
                                                                            : mcap::Compression::None}));
  BITELINE_TRY(
      writer.add_metadata({.name = "biteline.build", .values = {{"program", std::move(options.build)}}}));
  return RecordingWriter{std::move(writer)};
}

Result<void> RecordingWriter::attach(std::string_view name, std::string_view text) {
  const auto* const kept = std::ranges::find(k_kept_files, name, &KeptFile::name);
  BITELINE_EXPECTS(kept != k_kept_files.end());
  return writer_.attach({.log_time_ns = log_time(now_ns_),
                         .create_time_ns = log_time(now_ns_),
                         .name = std::string{name},
                         .media_type = std::string{kept->media_type},
                         .data = view(text),
                         .crc = 0});
}

Result<void> RecordingWriter::add_channels() {
  const auto add = [&](const char* topic, const char* encoding, std::string name, const char* schema_encoding,
                       std::string schema) -> Result<std::uint16_t> {
    BITELINE_ASSIGN(const std::uint16_t id,
                    writer_.add_schema(std::move(name), schema_encoding, std::move(schema)));
    return writer_.add_channel(id, topic, encoding);
  };
  BITELINE_ASSIGN(pose_, add(topic::k_pose, "json", "biteline.Pose", "jsonschema", k_pose_schema));
  BITELINE_ASSIGN(frame_, add(topic::k_frame, "json", "biteline.Frame", "jsonschema", k_frame_schema));
  BITELINE_ASSIGN(picture_, add_cdr_channel(topic::k_picture, k_picture_schema_name, k_picture_schema));
  const auto wire_schema = wire::binary_schema();
  BITELINE_ASSIGN(scan_, add(topic::k_scan, "flatbuffer", "biteline.wire.fb.Envelope", "flatbuffer",
                             std::string{wire_schema.begin(), wire_schema.end()}));
  BITELINE_ASSIGN(event_, add(topic::k_event, "json", "biteline.Event", "jsonschema", k_event_schema));
  return {};
}

Result<std::uint16_t> RecordingWriter::add_cdr_channel(const char* topic, std::string schema_name,
                                                       std::string schema) {
  BITELINE_ASSIGN(const std::uint16_t id,
                  writer_.add_schema(std::move(schema_name), "ros2msg", std::move(schema)));
  return writer_.add_channel(id, topic, "cdr");
}

Result<void> RecordingWriter::add_cdr(std::uint16_t channel, std::int64_t camera_ns,
                                      std::span<const std::uint8_t> message) {
  return write(channel, camera_ns, message);
}

Result<void> RecordingWriter::write(std::uint16_t channel, std::int64_t time_ns, mcap::View data) {
  BITELINE_EXPECTS(channel != 0);
  now_ns_ = time_ns;
  timed_ = true;
  if (!early_.empty()) BITELINE_TRY(write_early());
  return writer_.write({.channel_id = channel,
                        .sequence = counts_[channel]++,
                        .log_time_ns = log_time(time_ns),
                        .publish_time_ns = log_time(time_ns),
                        .data = data});
}

Result<void> RecordingWriter::add_pose(const PoseRow& row, std::int64_t camera_ns) {
  return write(pose_, camera_ns, view(message_of(row)));
}

Result<void> RecordingWriter::add_picture(const FrameRow& row, std::span<const std::uint8_t> png) {
  BITELINE_TRY(write(frame_, row.stamp_ns, view(message_of(row))));
  return write(picture_, row.stamp_ns, picture_message(row.stamp_ns, png));
}

Result<void> RecordingWriter::add_message(const wire::Message& message, std::span<const std::uint8_t> bytes) {
  if (const auto* profile = std::get_if<profile::Profile>(&message.body)) {
    return write(scan_, profile->header.exposure_mid.time_since_epoch().count(), bytes);
  }
  // The hello has no time of its own; it is written with what comes next, before it.
  if (!timed_ && early_.size() < k_most_early) {
    early_.emplace_back(message, wire::Bytes{bytes.begin(), bytes.end()});
    return {};
  }
  return write_told(message, bytes);
}

Result<void> RecordingWriter::write_early() {
  for (const auto& [message, bytes] : std::exchange(early_, {})) {
    BITELINE_TRY(write_told(message, bytes));
  }
  return {};
}

// What is no profile, and what it says for people.
Result<void> RecordingWriter::write_told(const wire::Message& message, std::span<const std::uint8_t> bytes) {
  using Json = nlohmann::ordered_json;
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

Result<void> RecordingWriter::flush() {
  return writer_.flush();
}

Result<std::string> RecordingWriter::close() {
  BITELINE_TRY(write_early());
  return writer_.close();
}

}  // namespace biteline::recording
