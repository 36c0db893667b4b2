// SPDX-License-Identifier: MIT
#pragma once
/// \file What a batch runs on: sessions, clouds, and recordings that are made when their turn comes.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::batch {

enum class RecordingKind : std::uint8_t {
  Session,      ///< a folder with cam0/ and pose0/, or its MCAP file; replayed
  Cloud,        ///< a file; extracted
  MadeSession,  ///< by `biteline-cell record`
  MadeCloud,    ///< by `biteline-cell record-cloud`
};

[[nodiscard]] const char* name_of(RecordingKind kind);
[[nodiscard]] Result<RecordingKind> recording_kind(const std::string& name);
[[nodiscard]] inline bool is_made(RecordingKind kind) {
  return kind == RecordingKind::MadeSession || kind == RecordingKind::MadeCloud;
}

struct Recording {
  std::string name;  ///< by which people and comparisons know it; one of its kind in a plan
  RecordingKind kind{RecordingKind::Cloud};
  std::filesystem::path path;       ///< absolute; empty when made
  std::vector<std::string> recipe;  ///< what biteline-cell is told, when made
  std::string hash;                 ///< SHA-256 of all that decides the result, the truth included
  std::uint64_t bytes{0};
};

/// The true line of a recording that lies at `path`: truth/groove.csv in it or beside it, when it is there.
[[nodiscard]] std::filesystem::path truth_of(RecordingKind kind, const std::filesystem::path& path);

/// Hash and size of a session or cloud as it is now.
struct Fingerprint {
  std::string hash;
  std::uint64_t bytes{0};
};
[[nodiscard]] Result<Fingerprint> fingerprint(RecordingKind kind, const std::filesystem::path& path);

/// The recordings that a manifest names, by name, without their hashes; each once.
///
/// A manifest is a text: a folder, a session (or its .mcap file), a cloud or a pattern (* ? []) on each line,
/// relative to the manifest's own folder; # begins a comment.  A folder is searched; folders called truth and
/// stages are left out.  In place of a manifest a folder or a cloud does.  A line that finds nothing is an
/// error.
[[nodiscard]] Result<std::vector<Recording>> find_recordings(const std::filesystem::path& manifest);

}  // namespace biteline::batch
