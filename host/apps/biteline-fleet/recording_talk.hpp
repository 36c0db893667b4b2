// SPDX-License-Identifier: MIT
#pragma once
/// \file The running centre's talk with the cells about recordings: pieces in, asks out.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/fleet/recording_taker.hpp"

namespace biteline::fleet {

/// Thread: one owner.
class RecordingTalk {
 public:
  using Clock = RecordingTaker::Clock;
  using Publish = std::function<void(const std::string& topic, const std::string& payload)>;

  /// Empty: this centre keeps no recordings, and says so of each that is asked for.
  RecordingTalk(const std::filesystem::path& folder, const RecordingLimits& limits);

  /// True: this message was about recordings.  An Error says what is wrong with it.
  [[nodiscard]] Result<bool> hear(std::string_view topic, std::string_view payload);
  /// Puts what came into files, the state into the database, and asks for more.
  [[nodiscard]] Result<void> work(Centre& centre, const Publish& publish, Clock::time_point now);
  /// There is more to do than the next message.
  [[nodiscard]] bool busy() const { return taker_ && taker_->busy(); }
  void forget() { pieces_.clear(); }

 private:
  [[nodiscard]] Result<void> read_open(Recordings& recordings, Clock::time_point now);

  std::optional<RecordingTaker> taker_;
  RecordingLimits limits_;
  std::vector<std::pair<std::string, Piece>> pieces_;
  std::vector<FetchRow> open_;
  std::map<std::int64_t, FetchRow> changed_;  ///< not in the database yet
  Clock::time_point read_at_{}, tidy_at_{};
};

}  // namespace biteline::fleet
