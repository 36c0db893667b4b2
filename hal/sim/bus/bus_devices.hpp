// SPDX-License-Identifier: MIT
#pragma once
/// \file The sensor's devices over the simulated wires: what hal/linux has on a board, `sim` has here.

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "hal/api/can_bus.hpp"
#include "hal/api/edge_in.hpp"
#include "hal/api/gpio_out.hpp"
#include "hal/api/pwm_out.hpp"
#include "hal/api/safety_in.hpp"
#include "hal/linux/posix/descriptor.hpp"
#include "hal/sim/bus/message.hpp"

namespace biteline::sim {

/// One connection to the cell.  A dead cell is Errc::DeviceLost.
class BusConnection {
 public:
  [[nodiscard]] static Result<BusConnection> connect(const std::string& name);

  [[nodiscard]] Result<void> send(const BusMessage& message) noexcept;
  /// Errc::Timeout when none came.
  [[nodiscard]] Result<BusMessage> receive(Nanoseconds timeout) noexcept;
  /// Sends and waits for the Level that answers.
  [[nodiscard]] Result<bool> ask(const BusMessage& message) noexcept;

 private:
  explicit BusConnection(hal::Descriptor socket) : socket_(std::move(socket)) {}
  hal::Descriptor socket_;
};

class SimGpioOut final : public hal::GpioOut {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SimGpioOut>> open(const std::string& name, Line line);
  [[nodiscard]] Result<void> set(bool active) noexcept override;
  [[nodiscard]] Result<bool> read_back() noexcept override;

 private:
  SimGpioOut(BusConnection connection, Line line) : connection_(std::move(connection)), line_(line) {}
  BusConnection connection_;
  Line line_;
};

class SimEdgeIn final : public hal::EdgeIn {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SimEdgeIn>> open(const std::string& name, Line line);
  [[nodiscard]] Result<hal::Edge> next_edge(Nanoseconds timeout) override;
  [[nodiscard]] Result<bool> level() noexcept override;
  [[nodiscard]] hal::EdgeHealth health() const noexcept override {
    return {.edges = edges_, .edges_lost = lost_};
  }

 private:
  SimEdgeIn(BusConnection edges, BusConnection levels, Line line)
      : edge_connection_(std::move(edges)), level_connection_(std::move(levels)), line_(line) {}
  BusConnection edge_connection_, level_connection_;  ///< two, so that level() may come from another thread
  Line line_;
  bool started_{false};
  std::uint64_t next_sequence_{0};
  std::atomic<std::uint64_t> edges_{0}, lost_{0};
};

class SimSafetyIn final : public hal::SafetyIn {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SimSafetyIn>> open(const std::string& name);
  [[nodiscard]] Result<hal::SafetyInputs> read() noexcept override;

 private:
  explicit SimSafetyIn(BusConnection connection) : connection_(std::move(connection)) {}
  BusConnection connection_;
};

/// The trigger's timer lives in the cell, as a PWM block lives outside the processor.
class SimPwmOut final : public hal::PwmOut {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SimPwmOut>> open(const std::string& name);
  [[nodiscard]] Result<hal::PwmSettings> configure(const hal::PwmSettings& wanted) override;
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<void> stop() noexcept override;
  [[nodiscard]] bool running() const noexcept override { return running_; }

 private:
  explicit SimPwmOut(BusConnection connection) : connection_(std::move(connection)) {}
  [[nodiscard]] Result<void> tell(const hal::PwmSettings& settings) noexcept;
  BusConnection connection_;
  hal::PwmSettings settings_{};
  bool configured_{false};
  std::atomic<bool> running_{false};
};

/// The pose bus.  `received` of a frame is when it stood on the wire, as a controller with hardware stamps
/// gives it.
class SimCanBus final : public hal::CanBus {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SimCanBus>> open(const std::string& name);
  [[nodiscard]] Result<void> set_filters(std::span<const hal::CanFilter> filters) override;
  [[nodiscard]] Result<hal::CanFrame> receive(Nanoseconds timeout) override;
  [[nodiscard]] Result<void> send(const hal::CanFrame& frame) override;
  [[nodiscard]] hal::CanHealth health() const noexcept override;

 private:
  explicit SimCanBus(BusConnection connection) : connection_(std::move(connection)) {}
  [[nodiscard]] bool passes(const hal::CanFrame& frame) const;
  BusConnection connection_;
  static constexpr std::size_t k_most_filters = 16;
  std::array<hal::CanFilter, k_most_filters> filters_{};
  std::size_t filter_count_{0};
  std::atomic<bool> down_{false};
  std::atomic<std::uint64_t> received_{0}, sent_{0};
};

}  // namespace biteline::sim
