// SPDX-License-Identifier: MIT
#pragma once
/// \file recording.yaml: how a live scan was recorded, and whether all of it is there.

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/core/result.hpp"

namespace biteline::session {

/// What a replay needs beyond the tables to find the same points, and what the recording left out.
struct RecordingFacts {
  std::string sensor{};   ///< what the sensor calls itself
  std::string version{};  ///< of its program
  // How peaks were found, under the names of the command line.
  std::string peak_mode{"matched"};
  std::string peak_choice{"continuity"};
  double peak_threshold_grey{0};
  double peak_width_min_px{0};
  double peak_width_max_px{0};
  bool second_exposures{false};  ///< every second frame is the longer one of a bracket
  bool laser_off_frames{false};  ///< every second frame was taken without laser
  /// The scan ended, everything that the sensor processed is in the folder, and the pictures' replay gives
  /// the same bits.  False while it is written.
  bool complete{false};
  std::uint32_t pictures_every{1};     ///< the first of so many was wanted; 0: none
  std::uint64_t pictures{0};           ///< written
  std::uint64_t pictures_left_out{0};  ///< the disk was slower than the camera, or full
  std::uint64_t poses{0};
  std::uint64_t poses_left_out{0};
  std::uint64_t messages{0};  ///< in scan.btln: hello, profiles, end
  std::uint64_t messages_left_out{0};
  /// Profiles that the pictures' replay makes otherwise: stamped before all their poses had come, or dropped.
  std::uint64_t unrepeatable{0};
  std::string fault{};  ///< what ended the recording before the scan; empty: nothing did
};

[[nodiscard]] Result<RecordingFacts> read_recording_facts(const std::filesystem::path& file);
[[nodiscard]] std::string recording_facts_text(const RecordingFacts& facts);

}  // namespace biteline::session
