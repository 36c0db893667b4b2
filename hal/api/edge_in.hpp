// SPDX-License-Identifier: MIT
#pragma once
/// \file One input line with stamped edges: the camera's strobe echo, the laser interlock, a start button.

#include <cstdint>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::hal {

struct Edge {
  SensorClock::time_point stamp;  ///< taken in the interrupt
  bool rising{false};             ///< inactive to active (active-low wiring already undone)
  std::uint64_t sequence{0};      ///< counts the edges of this line, gaps are losses
};

struct EdgeHealth {
  std::uint64_t edges{0};
  std::uint64_t edges_lost{0};  ///< the kernel's queue ran over
};

/// Watching from open() to the end of the object; no further states.
/// Thread: next_edge() from one thread; level() and health() from any.  RT: waits in the kernel, allocates
/// nothing.
class EdgeIn {
 public:
  EdgeIn() = default;
  EdgeIn(const EdgeIn&) = delete;
  EdgeIn& operator=(const EdgeIn&) = delete;
  virtual ~EdgeIn() = default;

  /// Oldest edge not yet given; Errc::Timeout when none came.
  [[nodiscard]] virtual Result<Edge> next_edge(Nanoseconds timeout) = 0;

  /// true: active, now.
  [[nodiscard]] virtual Result<bool> level() noexcept = 0;

  [[nodiscard]] virtual EdgeHealth health() const noexcept = 0;
};

}  // namespace biteline::hal
