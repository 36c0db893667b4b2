// SPDX-License-Identifier: MIT
#pragma once
/// \file A stop counts up and nothing counts it down: what was said before it is over for good.

#include <atomic>
#include <cstdint>

namespace biteline::robot {

class Stops;

/// How many stops there had been when an order was heard.  Whatever follows from the order (scan, result,
/// path) carries its mark.
class StopMark {
 public:
  /// Of no order: as if stopped.
  StopMark() = default;
  [[nodiscard]] bool stopped() const;

 private:
  friend class Stops;
  StopMark(const Stops& stops, std::uint64_t count) : stops_{&stops}, count_{count} {}
  const Stops* stops_{nullptr};
  std::uint64_t count_{0};
};

/// The cell's.  Thread: safe from any, and from a signal handler; waits for nothing.  It outlives its marks.
class Stops {
 public:
  Stops() = default;
  Stops(const Stops&) = delete;
  Stops& operator=(const Stops&) = delete;

  /// Ends every order that was heard before.
  void stop() { ++count_; }
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Of an order that is heard now.
  [[nodiscard]] StopMark now() const { return {*this, count_}; }
  /// Of one that was heard when the count was so.
  [[nodiscard]] StopMark at(std::uint64_t count) const { return {*this, count}; }

 private:
  std::atomic<std::uint64_t> count_{0};
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "counted up in a signal handler");
};

inline bool StopMark::stopped() const {
  return stops_ == nullptr || count_ != stops_->count();
}

}  // namespace biteline::robot
