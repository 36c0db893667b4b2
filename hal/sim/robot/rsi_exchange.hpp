// SPDX-License-Identifier: MIT
#pragma once
/// \file A made KUKA controller that exchanges its pose for answers by RSI.

#include <cstdint>
#include <string>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/clocks.hpp"
#include "hal/sim/robot/udp_sender.hpp"

namespace biteline::sim {

/// As an RSI program with RIst, and SENTYPE ImFree; made, and never held against a real controller.  Like
/// the real one it ends the exchange after so many cycles without the answer of their own.
/// Thread: one owner.
class RsiExchange {
 public:
  struct Config {
    std::uint16_t port{0};        ///< on this machine, where it is heard
    Nanoseconds clock_offset{0};  ///< controller clock minus this machine's monotonic clock
    bool only_sends{false};       ///< ONLYSEND: no answer is missed
    int unanswered_most{100};     ///< the usual limit of the RSI object ETHERNET
  };
  struct Counts {
    std::uint64_t sent{0}, answered{0}, wrong{0};
    int unanswered{0};  ///< in a row
    bool ended{false};
  };
  [[nodiscard]] static Result<RsiExchange> open(const Config& config);

  /// One cycle: what came back for the cycle before, then the pose at `instant`.  Nothing once it has ended.
  void step(SensorClock::time_point instant, const SE3& T_base_flange);
  [[nodiscard]] const Counts& counts() const { return counts_; }

  /// The text of one cycle.
  [[nodiscard]] static std::string message(std::int64_t ipoc_ms, const SE3& T_base_flange, int unanswered);

 private:
  RsiExchange(const Config& config, UdpSender sender) : config_{config}, sender_{std::move(sender)} {}
  void hear();

  Config config_;
  UdpSender sender_;
  std::int64_t ipoc_ms_{0};
  Counts counts_;
};

}  // namespace biteline::sim
