// SPDX-License-Identifier: MIT
#pragma once
/// \file A made ABB controller that streams its pose by EGM.

#include <cstdint>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/clocks.hpp"
#include "hal/sim/robot/udp_sender.hpp"

namespace biteline::sim {

/// As EGMStreamStart has it, from the published egm.proto; made, and never held against a real controller.
/// Thread: one owner.
class EgmStream {
 public:
  struct Config {
    std::uint16_t port{0};           ///< on this machine, where it is heard
    Nanoseconds clock_offset{0};     ///< controller clock minus this machine's monotonic clock
    bool tells_measured_time{true};  ///< false: as software before RobotWare 6.07
  };
  [[nodiscard]] static Result<EgmStream> open(const Config& config);

  /// One cycle of the controller: the pose measured at `instant`.
  void send(SensorClock::time_point instant, const SE3& T_base_flange, bool program_running);
  /// One cycle whose message never arrives.
  void lose() { ++number_; }

  /// The message that the next send() of this pose sends.  \param stamp since the controller's epoch
  [[nodiscard]] std::vector<std::uint8_t> message(Nanoseconds stamp, const SE3& T_base_flange,
                                                  bool program_running) const;

 private:
  EgmStream(const Config& config, UdpSender sender) : config_{config}, sender_{std::move(sender)} {}

  Config config_;
  UdpSender sender_;
  std::uint32_t number_{0};
};

}  // namespace biteline::sim
