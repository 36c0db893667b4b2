// SPDX-License-Identifier: MIT
#pragma once
/// \file The running centre's talk with the cells about releases: words and asks in, plans and parts out.

#include <chrono>
#include <functional>
#include <map>
#include <string>

#include "host/fleet/releases.hpp"

namespace biteline::fleet {

/// Keeps the last of each cell until the database has taken it.  Thread: one owner.
class ReleaseTalk {
 public:
  using Clock = std::chrono::steady_clock;
  using Publish = std::function<void(const std::string& topic, const std::string& payload)>;

  /// True: this message was about releases.  An Error says what is wrong with it.
  [[nodiscard]] Result<bool> hear(std::string_view topic, std::string_view text);
  /// Takes what was heard into the database and answers; decides switches, each second.
  [[nodiscard]] Result<void> work(Centre& centre, const Publish& publish, Clock::time_point now);
  void forget();

 private:
  std::map<std::string, ReleaseWord> words_;
  std::map<std::string, PartAsk> asks_;
  Clock::time_point decide_at_{};
};

}  // namespace biteline::fleet
