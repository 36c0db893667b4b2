// SPDX-License-Identifier: MIT
#pragma once
/// \file A CAN or CAN FD controller.

#include <array>
#include <cstdint>
#include <span>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::hal {

struct CanFrame {
  std::uint32_t id{0};  ///< 11 bit, or 29 bit when `extended`
  bool extended{false};
  bool fd{false};               ///< CAN FD frame (up to 64 bytes)
  bool bit_rate_switch{false};  ///< CAN FD data phase at the faster rate
  std::uint8_t size_bytes{0};
  std::array<std::uint8_t, 64> data{};
  SensorClock::time_point received;  ///< by the controller or its interrupt; unset when sending
  bool stamp_estimated{false};       ///< the kernel's stamp was unusable: `received` is the time of reading
};

/// Frames with (id & mask) == (filter id & mask) pass.
struct CanFilter {
  std::uint32_t id{0};
  std::uint32_t mask{0};
  bool extended{false};
};

enum class CanState { ErrorActive, ErrorWarning, ErrorPassive, BusOff, Down };

struct CanHealth {
  CanState state{CanState::Down};
  std::uint64_t frames_received{0};
  std::uint64_t frames_sent{0};
  std::uint64_t frames_dropped{0};  ///< by the kernel: our queue was full
  std::uint64_t bus_errors{0};
  std::uint64_t restarts{0};  ///< returns from bus-off
  std::uint64_t stamps_estimated{
      0};  ///< the kernel's stamp was unusable (wall clock stepped): time of reading instead
};

/// Open from open() to the end of the object.  Bus-off is a state and not the end: the kernel restarts the
/// controller (restart-ms), receive() goes on timing out meanwhile.  An interface that goes away is
/// Errc::DeviceLost. Thread: one receiver, one sender.  RT: no allocation.
class CanBus {
 public:
  CanBus() = default;
  CanBus(const CanBus&) = delete;
  CanBus& operator=(const CanBus&) = delete;
  virtual ~CanBus() = default;

  /// Empty: everything passes.
  [[nodiscard]] virtual Result<void> set_filters(std::span<const CanFilter> filters) = 0;
  [[nodiscard]] virtual Result<CanFrame> receive(Nanoseconds timeout) = 0;
  /// Errc::Overrun when the transmit queue is full; never waits.
  [[nodiscard]] virtual Result<void> send(const CanFrame& frame) = 0;
  [[nodiscard]] virtual CanHealth health() const noexcept = 0;
};

}  // namespace biteline::hal
