// SPDX-License-Identifier: MIT
#pragma once
/// \file Room on the disk: the oldest recordings go, those that are being written stay.

#include <cstdint>
#include <filesystem>

#include "common/core/result.hpp"

namespace biteline::record {

/// A folder that is being written.  The system lets go of it when its program ends, however it ends.
class HeldFolder {
 public:
  /// Errc::WrongState when somebody else holds it.
  [[nodiscard]] static Result<HeldFolder> hold(const std::filesystem::path& folder);
  HeldFolder(HeldFolder&& other) noexcept;
  HeldFolder& operator=(HeldFolder&& other) noexcept;
  ~HeldFolder();

 private:
  explicit HeldFolder(int number) : number_{number} {}
  int number_{-1};
};

/// Removes the oldest recordings of `series` (free_session_folder() made their names) until the others have
/// at most `keep_bytes`.  Never one that is held, nor a folder without recording.yaml.  Returns how many it
/// removed.  Takes as long as the disk does.
std::size_t make_room(const std::filesystem::path& series, std::uint64_t keep_bytes);

}  // namespace biteline::record
