// SPDX-License-Identifier: MIT
#pragma once
/// \file The centre's side of recordings: what comes of them, in files.

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "host/fleet/recording_messages.hpp"
#include "host/fleet/recordings.hpp"
#include "host/records/digest/digest.hpp"

namespace biteline::fleet {

/// How often a whole that does not have its SHA-256 is fetched anew.
inline constexpr int k_most_fetch_tries = 3;

/// FOLDER/CELL/BOOK/SCAN.tar, whole and checked; beside it .part while it comes.  No network and no database
/// here: rows and pieces in, rows and asks out.  Thread: one owner.
class RecordingTaker {
 public:
  using Clock = std::chrono::steady_clock;

  explicit RecordingTaker(std::filesystem::path folder) : folder_{std::move(folder)} {}

  /// A fetch that is open.  Returns what is to be asked now, if anything.
  [[nodiscard]] std::optional<FetchAsk> look(const FetchRow& row, Clock::time_point now);
  /// The changed row, if this piece was one that is waited for.
  [[nodiscard]] std::optional<FetchRow> hear(const std::string& cell, const Piece& piece,
                                             Clock::time_point now);
  /// Some milliseconds of work: checks what is whole.  The changed rows.
  [[nodiscard]] std::vector<FetchRow> work(Clock::time_point now);
  [[nodiscard]] bool busy() const;

  [[nodiscard]] std::filesystem::path file_of(const FetchRow& row) const;

 private:
  struct Coming {
    FetchRow row;
    int left{0};  ///< pieces that were asked for
    Clock::time_point asked{};
    std::optional<Digest> digest{};  ///< while the whole is being checked
    std::int64_t hashed{0};
  };
  [[nodiscard]] std::filesystem::path part_of(const FetchRow& row) const;
  [[nodiscard]] Result<void> take(Coming& coming, const Piece& piece);
  [[nodiscard]] Result<bool> check_some(Coming& coming);
  [[nodiscard]] FetchRow end(std::int64_t number, FetchState state, const std::string& words);

  std::filesystem::path folder_;
  std::map<std::int64_t, Coming> coming_;
};

}  // namespace biteline::fleet
