// SPDX-License-Identifier: MIT
#pragma once
/// \file PwmOut by a thread that toggles a GPIO line: the fallback for boards without a free hardware timer.

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>

#include "hal/api/gpio_out.hpp"
#include "hal/api/pwm_out.hpp"
#include "hal/linux/pwm/pulse_grid.hpp"

namespace biteline::hal {

/// Absolute sleeps on CLOCK_MONOTONIC in a SCHED_FIFO thread.  Its edges carry the scheduler's latency (tens
/// of microseconds on PREEMPT_RT, milliseconds without), so tie exposures to the strobe echo, never to the
/// grid.
class SoftwarePwm final : public PwmOut {
 public:
  struct Config {
    int priority{0};  ///< SCHED_FIFO 1..99; 0: the scheduler of the caller
    bool require_real_time{
        true};  ///< without the right to SCHED_FIFO: true: start() refuses; false: runs without
  };
  SoftwarePwm(std::unique_ptr<GpioOut> line, const Config& config);
  ~SoftwarePwm() override;

  [[nodiscard]] Result<PwmSettings> configure(const PwmSettings& wanted) override;
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<void> stop() noexcept override;
  [[nodiscard]] bool running() const noexcept override { return running_.load(); }
  [[nodiscard]] bool hardware_timed() const noexcept override { return false; }

  [[nodiscard]] PulseHealth pulse_health() const;
  /// Times that the line did not take a level.
  [[nodiscard]] std::uint64_t line_faults() const { return line_faults_.load(); }

 private:
  void run(PwmSettings settings);
  void drive(bool active);

  std::unique_ptr<GpioOut> line_;
  Config config_;
  mutable std::mutex mutex_;  ///< settings_ and health_; held for copies only
  PwmSettings settings_;
  bool changed_{false};
  PulseHealth health_;
  std::atomic<bool> running_{false};
  std::atomic<bool> stop_wanted_{false};
  std::atomic<std::uint64_t> line_faults_{0};
  std::thread thread_;
};

}  // namespace biteline::hal
