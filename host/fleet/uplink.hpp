// SPDX-License-Identifier: MIT
#pragma once
/// \file What a cell sends next, and when again: the outbox against the centre's word, without a network.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "host/fleet/messages.hpp"
#include "host/records/memory/outbox.hpp"

namespace biteline::fleet {

/// Sent and not yet committed, at most.
inline constexpr int k_most_on_the_way = 100;
/// Without a word of the centre for so long, all is sent again from where it stands.
inline constexpr std::chrono::seconds k_patience{5};
/// So often a row is sent as it is, while the centre answers and takes nothing.
inline constexpr int k_most_in_vain = 6;

/// Thread: one owner.
class Uplink {
 public:
  using Clock = std::chrono::steady_clock;

  /// There is a new line: nothing is sent until the centre has said where it stands.
  void begin_line() { committed_.reset(); }
  /// A memory of another name begins anew.
  void use_book(const std::string& book);
  void hear(const CommittedMessage& message, Clock::time_point now);

  /// Rows above this are to be sent now; nothing: none.
  [[nodiscard]] std::optional<std::int64_t> next(Clock::time_point now);
  /// How many, at most.
  [[nodiscard]] int room() const { return bare() ? 1 - on_the_way_ : k_most_on_the_way - on_the_way_; }
  /// The next row was sent often and never taken, though the centre answers: it goes alone, and as a stub.
  [[nodiscard]] bool bare() const { return in_vain_ >= k_most_in_vain; }
  void sent(std::int64_t seq, Clock::time_point now);

  /// Up to here the centre has all; 0: not known.
  [[nodiscard]] std::int64_t committed() const { return committed_.value_or(0); }

 private:
  std::string book_;
  std::optional<std::int64_t> committed_;
  std::int64_t sent_{0};
  int on_the_way_{0};
  int in_vain_{0};        ///< times that all was sent again, and nothing was taken
  bool answered_{false};  ///< since it was sent
  Clock::time_point progress_{};
};

}  // namespace biteline::fleet
