// SPDX-License-Identifier: MIT
#pragma once
/// \file A cell's side of releases: fetches what the centre wants it to have, checks it, keeps the plan.

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "host/fleet/release_messages.hpp"
#include "host/records/release/shelf.hpp"

namespace biteline::fleet {

/// Nothing is taken from the centre but what the signature vouches for.  No network here: messages in, asks
/// out. Thread: one owner.
class ReleaseKeeper {
 public:
  using Clock = std::chrono::steady_clock;
  using Ask = std::function<void(const PartAsk&)>;

  /// `key`: PEM of who may release.
  ReleaseKeeper(std::filesystem::path folder, std::filesystem::path key, Ask ask);

  /// An Error is of this cell's disk or key, or of the release; it stands in word().fault, too.
  [[nodiscard]] Result<void> hear(const ReleasePlan& plan, Clock::time_point now, std::int64_t now_ms);
  /// True: the release is whole now.
  [[nodiscard]] Result<bool> hear(const Part& part, Clock::time_point now);
  /// Asks again for what did not come, and writes down a switch whose time has come.
  [[nodiscard]] Result<void> look(Clock::time_point now, std::int64_t now_ms);
  [[nodiscard]] ReleaseWord word(std::int64_t now_ms) const;

 private:
  Result<void> want(const ReleasePlan& plan, Clock::time_point now);
  Result<void> plan_switch(const ReleasePlan& plan, std::int64_t now_ms);
  Result<bool> append(const Part& part);
  Result<void> take_in();
  void ask(Clock::time_point now);

  release::Shelf shelf_;
  std::filesystem::path key_;
  Ask ask_;
  std::string wanted_text_;                  ///< manifest that was checked last
  std::optional<release::Manifest> wanted_;  ///< vouched for
  std::int64_t have_{0};                     ///< of its bytes
  int coming_{0};                            ///< parts that were asked for
  Clock::time_point asked_{}, not_before_{};
  std::string fault_;
};

}  // namespace biteline::fleet
