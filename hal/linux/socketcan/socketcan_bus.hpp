// SPDX-License-Identifier: MIT
#pragma once
/// \file CanBus on a SocketCAN raw socket.

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "hal/api/can_bus.hpp"
#include "hal/linux/posix/descriptor.hpp"

struct msghdr;

namespace biteline::hal {

/// Receive stamps are the kernel's (taken in the driver's interrupt) on CLOCK_REALTIME, carried over to
/// CLOCK_MONOTONIC at the moment of reading; a step of the wall clock in between is noticed and counted
/// (CanHealth::stamps_estimated).
class SocketcanBus final : public CanBus {
 public:
  struct Config {
    std::string interface;              ///< "can0"
    bool fd{true};                      ///< also take CAN FD frames; off for a classic controller
    int receive_buffer_bytes{1 << 20};  ///< about 4000 frames, half a second of a full 1 Mbit/s bus
  };
  [[nodiscard]] static Result<std::unique_ptr<SocketcanBus>> open(const Config& config);

  [[nodiscard]] Result<void> set_filters(std::span<const CanFilter> filters) override;
  [[nodiscard]] Result<CanFrame> receive(Nanoseconds timeout) override;
  [[nodiscard]] Result<void> send(const CanFrame& frame) override;
  [[nodiscard]] CanHealth health() const noexcept override;

 private:
  SocketcanBus(Descriptor socket, const std::string& interface)
      : socket_{std::move(socket)}, interface_{interface} {}

  /// A data frame; Errc::Timeout for what was read and is none (error frames, a link that went down).
  Result<CanFrame> read_one();
  void on_error_frame(std::uint32_t error_class, std::uint8_t controller_state);
  struct Stamp {
    SensorClock::time_point instant;
    bool estimated{false};
  };
  Stamp receive_stamp(const ::msghdr& message);
  void set_state(CanState state) { state_.store(state, std::memory_order_relaxed); }

  Descriptor socket_;
  std::string interface_;
  std::optional<Nanoseconds> clocks_apart_;  ///< wall clock less monotonic, at the last frame
  SensorClock::time_point clocks_read_;
  std::atomic<CanState> state_{CanState::ErrorActive};
  std::atomic<std::uint64_t> received_{0};
  std::atomic<std::uint64_t> sent_{0};
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<std::uint64_t> bus_errors_{0};
  std::atomic<std::uint64_t> restarts_{0};
  std::atomic<std::uint64_t> stamps_estimated_{0};
};

}  // namespace biteline::hal
