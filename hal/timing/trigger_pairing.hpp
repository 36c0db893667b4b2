// SPDX-License-Identifier: MIT
#pragma once
/// \file Each exposure tied to the trigger edge that began it.

#include <array>
#include <cstdint>
#include <optional>

#include "common/time/clocks.hpp"

namespace biteline::hal {

struct PairingHealth {
  std::uint64_t paired{0};
  std::uint64_t frames_without_edge{0};
  std::uint64_t frames_with_two_edges{0};
  std::uint64_t edges_without_frame{0};
  std::uint64_t edges_overrun{0};  ///< given up because the ring was full: frames stopped coming
};

/// A frame's own stamp follows its edge by a latency between two known bounds (exposure, readout, transfer):
/// an edge that stands in that window is the frame's.  No count is needed, so nothing slips after a loss; a
/// window narrower than the trigger's period makes the answer unique. Thread: one owner.  RT: no allocation;
/// looks at no more than k_edges edges.
class TriggerPairing {
 public:
  struct Config {
    Nanoseconds latency_min{0};  ///< edge to the frame's stamp
    Nanoseconds latency_max{0};
  };
  explicit TriggerPairing(const Config& config) : config_{config} {}

  /// Pre: in the order of their stamps.
  void on_edge(SensorClock::time_point stamp);

  struct Match {
    std::optional<SensorClock::time_point> edge;  ///< nothing: none in the window, or two
    bool ambiguous{false};
  };
  /// Pre: frames in the order of their stamps; their edges were told before.
  Match on_frame(SensorClock::time_point stamp);

  [[nodiscard]] const PairingHealth& health() const { return health_; }

 private:
  static constexpr std::size_t k_edges = 256;  // 2.5 s at 100 Hz without a frame

  [[nodiscard]] SensorClock::time_point& at(std::size_t index) { return edges_[(first_ + index) % k_edges]; }
  void drop_first() {
    first_ = (first_ + 1) % k_edges;
    --count_;
  }

  Config config_;
  std::array<SensorClock::time_point, k_edges> edges_{};
  std::size_t first_{0};
  std::size_t count_{0};
  PairingHealth health_;
};

}  // namespace biteline::hal
