// SPDX-License-Identifier: MIT
#pragma once
/// \file A scan from its recorded messages (scan.btln): the profiles as they came, without pictures.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "common/core/result.hpp"
#include "host/intake/cloud_builder.hpp"
#include "host/intake/session_run.hpp"

namespace biteline::intake {

/// Profiles that are to be replayed in place of pictures.
struct ProfileSource {
  std::filesystem::path file;  ///< scan.btln
  std::string why;             ///< they are taken
};
/// Of a scan's own file, and of a live recording whose pictures do not repeat the scan.  Nothing: the
/// session's pictures are to be replayed.
[[nodiscard]] Result<std::optional<ProfileSource>> choose_profiles(const std::filesystem::path& input);

struct RecordedScan {
  SessionRun run;  ///< without times of the link
  /// Why it is not a whole scan: cut, ended early, or messages are missing.  Nothing: it is whole.
  std::optional<std::string> lacks;
};

/// Takes in every message before the file's end or first damage.  The points are bit for bit those that a
/// host had while the scan ran.  Errc::BadFormat when the file is no recorded scan.
[[nodiscard]] Result<RecordedScan> read_recorded_scan(const std::filesystem::path& file,
                                                      const OnProfile& on_profile);

}  // namespace biteline::intake
