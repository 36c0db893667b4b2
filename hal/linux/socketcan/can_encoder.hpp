// SPDX-License-Identifier: MIT
#pragma once
/// \file EncoderIn from a CANopen encoder (CiA 406) on the bus.

#include <memory>

#include "common/canpose/encoder.hpp"
#include "hal/api/can_bus.hpp"
#include "hal/api/encoder_in.hpp"

namespace biteline::hal {

/// Owns a CanBus of its own (a socket each costs nothing) and reads what came since the last call.
/// `errors` of a reading counts refused positions.  Thread: one owner, narrower than the interface's "any".
class CanEncoder final : public EncoderIn {
 public:
  struct Config {
    std::uint8_t node{1};          ///< CANopen node 1..127
    std::uint32_t range_ticks{0};  ///< object 6002h; 0: 32 bits
  };
  [[nodiscard]] static Result<std::unique_ptr<CanEncoder>> open(std::unique_ptr<CanBus> bus,
                                                                const Config& config);

  /// The last position; Errc::Timeout before the first one came.
  [[nodiscard]] Result<EncoderReading> read() noexcept override;

 private:
  CanEncoder(std::unique_ptr<CanBus> bus, const Config& config)
      : bus_{std::move(bus)}, id_{canpose::tpdo1_id(config.node)}, position_{config.range_ticks} {}

  std::unique_ptr<CanBus> bus_;
  std::uint32_t id_;
  canpose::PositionUnwrapper position_;
  std::uint64_t malformed_{0};
  bool has_reading_{false};
  SensorClock::time_point last_stamp_;
};

}  // namespace biteline::hal
