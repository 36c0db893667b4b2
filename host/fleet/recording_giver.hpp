// SPDX-License-Identifier: MIT
#pragma once
/// \file A cell's side of recordings: gives the folder of a scan piece by piece, when nothing else is to do.

#include <optional>

#include "host/fleet/recording_messages.hpp"
#include "host/records/archive/tar_stream.hpp"
#include "host/records/digest/digest.hpp"

namespace biteline::fleet {

/// Reads the service's folder of results and writes nothing.  No network here: asks in, pieces out.
/// Thread: one owner.
class RecordingGiver {
 public:
  explicit RecordingGiver(std::filesystem::path results) : results_{std::move(results)} {}

  /// The newest ask counts.
  void hear(const FetchAsk& ask);
  [[nodiscard]] bool asked() const { return ask_.has_value(); }
  /// One bounded step, some milliseconds of reading: a part of the SHA-256, or a piece to be sent now.
  /// `book`: of the cell's memory; empty: not known yet.  Call it only while the cell rests.
  [[nodiscard]] std::optional<Piece> step(const std::string& book);

 private:
  [[nodiscard]] Piece refuse(const std::string& why);
  [[nodiscard]] Result<void> hash_some();

  std::filesystem::path results_;
  std::optional<FetchAsk> ask_;
  int left_{0};  ///< pieces of this ask
  std::string scan_;
  std::optional<archive::TarStream> stream_;
  std::optional<Digest> digest_;
  std::uint64_t hashed_{0};
  std::string sha256_;  ///< empty until all is hashed
  bool given_{false};   ///< a piece with that SHA-256
};

/// A scan comes in or is worked out: the newest folder has no report yet.  One that has lain so for ten
/// minutes was left by a service that died.
[[nodiscard]] bool cell_works(const std::filesystem::path& results);

}  // namespace biteline::fleet
