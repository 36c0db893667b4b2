// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a recording's parts are kept: a session folder, or one MCAP file.

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/image/grey_image.hpp"
#include "common/session/recording_facts.hpp"
#include "firmware/pipeline/record_tap.hpp"

namespace biteline::record {

/// Who writes, in an MCAP file's head.
inline constexpr const char* k_recorder = "biteline-sensor";

struct StoreConfig {
  std::filesystem::path path;  ///< made here; nothing of that name may exist
  geometry::SensorModel model;
  std::string settings{};  ///< the set in use, as a settings file; empty: none is kept
};

/// Held (HeldRecording) as long as it lives.  What was added stays readable, whatever ends the program. After
/// an Error nothing more is added, but finish() may be tried.  Thread: one owner.
class RecordStore {
 public:
  RecordStore() = default;
  RecordStore(const RecordStore&) = delete;
  RecordStore& operator=(const RecordStore&) = delete;
  virtual ~RecordStore() = default;

  [[nodiscard]] virtual Result<void> add_poses(std::span<const pipeline::RecordedPose> poses) = 0;
  /// As it went over the wire.
  [[nodiscard]] virtual Result<void> add_message(std::span<const std::uint8_t> message) = 0;
  /// Whole or not at all; `packed`: smaller, and slower.  Pre: a later exposure than the picture's before.
  [[nodiscard]] virtual Result<void> add_picture(const pipeline::RecordedFrame& frame, bool packed) = 0;
  /// Once in a while: what waits in memory is written.
  [[nodiscard]] virtual Result<void> settle() { return {}; }
  /// `facts`: the last word.
  [[nodiscard]] virtual Result<void> finish(const session::RecordingFacts& facts) = 0;
};

/// A frame as the bytes of a PNG file.  Thread: one owner.
class PictureFile {
 public:
  /// Until the next call.
  [[nodiscard]] Result<std::span<const std::uint8_t>> of(const pipeline::RecordedFrame& frame, bool packed);

 private:
  image::GreyImage picture_;
  std::vector<std::uint8_t> bytes_;
};

/// `facts`: as they stand at the begin, not complete.
[[nodiscard]] Result<std::unique_ptr<RecordStore>> open_session_folder(const StoreConfig& config,
                                                                       const session::RecordingFacts& facts);
[[nodiscard]] Result<std::unique_ptr<RecordStore>> open_mcap_file(const StoreConfig& config,
                                                                  const session::RecordingFacts& facts);

}  // namespace biteline::record
