// SPDX-License-Identifier: MIT
#pragma once
/// \file Room on the disk: the oldest recordings go, those that are being written stay.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::record {

/// A recording that is being written.  The system lets go of it when its program ends, however it ends.
class HeldRecording {
 public:
  /// Errc::WrongState when somebody else holds it.
  [[nodiscard]] static Result<HeldRecording> hold(const std::filesystem::path& recording);
  HeldRecording(HeldRecording&& other) noexcept;
  HeldRecording& operator=(HeldRecording&& other) noexcept;
  ~HeldRecording();

 private:
  explicit HeldRecording(int number) : number_{number} {}
  int number_{-1};
};

/// Of a file's name: one MCAP file, not a session folder.
[[nodiscard]] bool is_mcap_name(const std::filesystem::path& recording);

/// `wanted` if there is nothing of that name, else the first of `wanted`-2, -3, ... that is free; a file
/// keeps its ending.
[[nodiscard]] std::filesystem::path free_name(const std::filesystem::path& wanted);

/// The recordings of `series` (free_name() made their names), the one that ended first before the others.
[[nodiscard]] std::vector<std::filesystem::path> recordings_of(const std::filesystem::path& series);

/// Removes the oldest recordings of `series` (free_name() made their names) until the others have at most
/// `keep_bytes`.  Never one that is held, nor a folder without recording.yaml, nor an MCAP file of others.
/// Returns how many it removed.  Takes as long as the disk does.
std::size_t make_room(const std::filesystem::path& series, std::uint64_t keep_bytes);

}  // namespace biteline::record
