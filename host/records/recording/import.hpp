// SPDX-License-Identifier: MIT
#pragma once
/// \file A recording's MCAP file back into a folder.

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/core/result.hpp"

namespace biteline::recording {

struct Imported {
  std::uint64_t pictures{0}, poses{0}, messages{0}, files{0};
  std::uint64_t pictures_without_pose{0};  ///< left out at the end of a cut file
  std::uint64_t strange{0};                ///< messages and files of others, left out
  std::string lacks;                       ///< where the file is cut or damaged; empty: it is whole
  /// A session; otherwise the folder has scan.btln only.
  [[nodiscard]] bool has_session() const { return pictures > 0 && poses > 0; }
};

/// Writes the session, so that its replay gives the same bits, and scan.btln with the same bytes.  Of a cut
/// or damaged file everything before that; recording.yaml then says that it is not complete.
/// `folder`: made here; nothing of that name may exist.  Errc::BadFormat when the file has no recording.
[[nodiscard]] Result<Imported> import_mcap(const std::filesystem::path& file,
                                           const std::filesystem::path& folder);

/// By its first bytes.
[[nodiscard]] bool is_mcap(const std::filesystem::path& file);

}  // namespace biteline::recording
