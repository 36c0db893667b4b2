// SPDX-License-Identifier: MIT
#pragma once
/// \file Writes a recording's MCAP file (docs/recording.md, "One file: MCAP"), from files or live.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/core/result.hpp"
#include "common/mcap/writer.hpp"
#include "common/recording/rows.hpp"
#include "common/wire/messages.hpp"

namespace biteline::recording {

/// Appends only: every beginning of the file is a recording.  Thread: one owner.  After an Error nothing more
/// may be written.
class RecordingWriter {
 public:
  struct Options {
    std::string library;  ///< who writes, with version
    std::string build;    ///< for the file's metadata
    bool packed{true};    ///< zstd
  };
  /// Errc::WriteFailed when the file exists.
  [[nodiscard]] static Result<RecordingWriter> create(const std::filesystem::path& file, Options options);

  /// One of k_kept_files.  Attached again it replaces the one before for a reader.
  [[nodiscard]] Result<void> attach(std::string_view name, std::string_view text);
  /// Once, before the first message.
  [[nodiscard]] Result<void> add_channels();
  /// `camera_ns`: the pose's time on the camera's clock.
  [[nodiscard]] Result<void> add_pose(const PoseRow& row, std::int64_t camera_ns);
  /// `png`: the whole file.
  [[nodiscard]] Result<void> add_picture(const FrameRow& row, std::span<const std::uint8_t> png);
  /// `bytes`: `message` as it came.  What has no time of its own gets that of what came before, or next.
  [[nodiscard]] Result<void> add_message(const wire::Message& message, std::span<const std::uint8_t> bytes);
  /// One more, of CDR messages: its number.  After add_channels(), before the first message.
  [[nodiscard]] Result<std::uint16_t> add_cdr_channel(const char* topic, std::string schema_name,
                                                      std::string schema);
  [[nodiscard]] Result<void> add_cdr(std::uint16_t channel, std::int64_t camera_ns,
                                     std::span<const std::uint8_t> message);
  /// What was written so far survives the program's end.
  [[nodiscard]] Result<void> flush();
  /// The last link of the hash chain.
  [[nodiscard]] Result<std::string> close();
  /// Of the file, without the chunk that is being filled.
  [[nodiscard]] std::uint64_t bytes_written() const { return writer_.bytes_written(); }

 private:
  explicit RecordingWriter(mcap::Writer writer) : writer_{std::move(writer)} {}
  [[nodiscard]] Result<void> write(std::uint16_t channel, std::int64_t time_ns, mcap::View data);
  [[nodiscard]] Result<void> write_early();
  [[nodiscard]] Result<void> write_told(const wire::Message& message, std::span<const std::uint8_t> bytes);

  /// Messages before the first that has a time: a hello, and what may come with it.
  static constexpr std::size_t k_most_early = 100;

  mcap::Writer writer_;
  std::int64_t now_ns_{0};
  bool timed_{false};  ///< now_ns_ is a message's
  std::uint16_t pose_{0}, frame_{0}, picture_{0}, scan_{0}, event_{0};
  std::map<std::uint16_t, std::uint32_t> counts_;
  std::vector<std::pair<wire::Message, wire::Bytes>> early_;
};

}  // namespace biteline::recording
