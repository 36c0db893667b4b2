// SPDX-License-Identifier: MIT
#pragma once
/// \file A cell's side of releases: fetches what the centre wants it to have, checks it, keeps the plan.

#include <chrono>
#include <functional>
#include <future>
#include <optional>
#include <string>

#include "host/fleet/release_messages.hpp"
#include "host/records/release/order.hpp"
#include "host/records/release/shelf.hpp"

namespace biteline::fleet {

/// Nothing is taken from the centre but what the signature vouches for.  No network here: messages in, asks
/// out. Thread: one owner.
class ReleaseKeeper {
 public:
  using Clock = std::chrono::steady_clock;
  using Ask = std::function<void(const PartAsk&)>;

  /// `key`: PEM of who may release and switch; `cell`: this one's name, which an order must have.
  ReleaseKeeper(std::filesystem::path folder, std::filesystem::path key, std::string cell, Ask ask);

  /// Makes the folder, so that the service finds it before there is a release.
  [[nodiscard]] Result<void> begin() const;
  /// An Error is of this cell's disk or key, or of the release; it stands in word().fault, too.
  [[nodiscard]] Result<void> hear(const ReleasePlan& plan, Clock::time_point now, std::int64_t now_ms);
  /// True: all its bytes are here; they are checked and unpacked beside this thread, see look().
  [[nodiscard]] Result<bool> hear(const Part& part, Clock::time_point now);
  /// Asks again for what did not come, takes in what is checked, and writes down a switch whose time has
  /// come. True: word() says something new.
  [[nodiscard]] Result<bool> look(Clock::time_point now, std::int64_t now_ms);
  /// A release is being checked and unpacked.
  [[nodiscard]] bool busy() const { return taking_.valid(); }
  [[nodiscard]] ReleaseWord word(std::int64_t now_ms) const;

 private:
  Result<void> want(const ReleasePlan& plan, Clock::time_point now);
  [[nodiscard]] Result<release::HeardOrder> vouched(const ReleasePlan::Switch& turn) const;
  Result<void> plan_switch(const ReleasePlan& plan, std::int64_t now_ms);
  Result<bool> append(const Part& part);
  void take_in();
  [[nodiscard]] Result<void> taken(Clock::time_point now);
  Result<void> give_up(const Error& error, Clock::time_point now);
  void ask(Clock::time_point now);

  release::Shelf shelf_;
  std::filesystem::path key_;
  std::string cell_;
  Ask ask_;
  std::string wanted_text_;                  ///< manifest that was checked last
  std::optional<release::Manifest> wanted_;  ///< vouched for
  std::int64_t have_{0};                     ///< of its bytes
  int coming_{0};                            ///< parts that were asked for
  Clock::time_point asked_{}, not_before_{};
  std::string fault_;        ///< of the release
  std::string order_fault_;  ///< of its switch
  std::int64_t refused_{0};  ///< the order of that fault
  int tries_{0};             ///< times that this release came and could not be used
  std::future<Result<void>> taking_;
};

}  // namespace biteline::fleet
