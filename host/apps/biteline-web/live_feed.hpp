// SPDX-License-Identifier: MIT
#pragma once
/// \file From those who have something to show to all who watch, so that a slow one holds up nobody.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/biteline-web/live_messages.hpp"

namespace biteline::web {

/// What waits for one watcher.  Of pictures, profiles, lines and the arm only the newest; the cloud's pieces
/// in order, the oldest of more than k_most_pieces go.  Thread: the server's.
class LiveQueue {
 public:
  static constexpr std::size_t k_most_pieces = 256;

  explicit LiveQueue(std::function<void()> wake) : wake_{std::move(wake)} {}

  void put(LiveKind kind, LiveBytes bytes);
  /// The next to send; kinds take turns, so that pictures do not starve the rest.
  [[nodiscard]] LiveBytes take();
  /// Replaced or dropped before they could be sent.
  [[nodiscard]] std::uint64_t skipped() const { return skipped_; }

 private:
  std::function<void()> wake_;
  std::array<LiveBytes, k_live_kinds> newest_;
  std::deque<LiveBytes> pieces_;
  std::size_t turn_{0};
  std::uint64_t skipped_{0};
};

/// Texts in order for one watcher; the oldest of more than k_most_waiting go, which `seq` shows.
class EventQueue {
 public:
  static constexpr std::size_t k_most_waiting = 256;

  explicit EventQueue(std::function<void()> wake) : wake_{std::move(wake)} {}
  void put(std::shared_ptr<const std::string> text);
  [[nodiscard]] std::shared_ptr<const std::string> take();

 private:
  std::function<void()> wake_;
  std::deque<std::shared_ptr<const std::string>> waiting_;
};

/// Thread: the server's.
class LiveFeed {
 public:
  /// The newest of each kind is put into `queue` at once.
  void add(const std::shared_ptr<LiveQueue>& queue);
  void add(const std::shared_ptr<EventQueue>& queue);
  void publish(LiveKind kind, LiveBytes bytes);
  void publish_event(std::string text);
  /// Of a scan that begins: the line and the cloud of the one before are no longer shown to who comes.
  void forget_scan();

  [[nodiscard]] int watchers();
  [[nodiscard]] int listeners();
  [[nodiscard]] std::uint64_t published(LiveKind kind) const {
    return published_[static_cast<std::size_t>(kind)];
  }

 private:
  std::vector<std::weak_ptr<LiveQueue>> live_;
  std::vector<std::weak_ptr<EventQueue>> events_;
  std::array<LiveBytes, k_live_kinds> newest_;
  std::deque<LiveBytes> cloud_;  ///< of the scan in work, for who comes late
  std::array<std::uint64_t, k_live_kinds> published_{};
};

}  // namespace biteline::web
