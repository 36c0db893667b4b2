// SPDX-License-Identifier: MIT
#pragma once
/// \file Trigger edges against the train they should be: missed, doubled and late ones found by time alone.

#include <cstdint>
#include <optional>

#include "common/time/clocks.hpp"

namespace biteline::hal {

enum class EdgeVerdict {
  OnTime,
  Late,     ///< or early: off the grid by more than the tolerance, nearer to its own slot than to any other
  Doubled,  ///< a second edge in a slot: no pulse of the train
  AfterMissed,  ///< on time, with empty slots before it
};

struct EdgeGridHealth {
  std::uint64_t slots{0};  ///< with an edge
  std::uint64_t missed{0};
  std::uint64_t doubled{0};
  std::uint64_t late{0};
  Nanoseconds deviation_max{0};  ///< of edges on time
};

/// The grid is the train's period, its phase follows the edges on time slowly, so that two clocks' drift
/// never counts. Thread: one owner.  RT: arithmetic only.
class EdgeGrid {
 public:
  struct Config {
    Nanoseconds period{0};
    Nanoseconds tolerance{0};  ///< of an edge on time; below half a period
  };
  explicit EdgeGrid(const Config& config) : config_{config} {}

  /// Pre: edges in the order of their stamps.
  EdgeVerdict on_edge(SensorClock::time_point stamp);

  /// Slot of the last edge, counted from 0 at the first.
  [[nodiscard]] std::uint64_t slot() const { return slot_; }
  [[nodiscard]] const EdgeGridHealth& health() const { return health_; }

 private:
  Config config_;
  std::optional<SensorClock::time_point> slot_time_;  ///< of the last edge's slot
  std::uint64_t slot_{0};
  EdgeGridHealth health_;
};

}  // namespace biteline::hal
