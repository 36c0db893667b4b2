// SPDX-License-Identifier: MIT
#pragma once
/// \file Watchdog on an output line: a retriggerable monostable of the board that lets the laser through
/// while edges come.

#include <memory>

#include "hal/api/gpio_out.hpp"
#include "hal/api/watchdog.hpp"

namespace biteline::hal {

/// Each feed() turns the line over, so that a rising edge comes every second time.  Its patience is the
/// circuit's and cannot be set: arm() gives back what it was asked for.  What becomes of the line when the
/// process dies does not matter, edges stay out either way.
class LineWatchdog final : public Watchdog {
 public:
  explicit LineWatchdog(std::unique_ptr<GpioOut> line) : line_{std::move(line)} {}

  [[nodiscard]] Result<Nanoseconds> arm(Nanoseconds timeout) override;
  [[nodiscard]] Result<void> feed() noexcept override;
  /// The laser is dark once the circuit has run out.
  [[nodiscard]] Result<void> disarm() override;

 private:
  std::unique_ptr<GpioOut> line_;
  bool armed_{false};
  bool level_{false};
};

}  // namespace biteline::hal
