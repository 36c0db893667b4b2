// SPDX-License-Identifier: MIT
#pragma once
/// \file What restarts or stops the sensor when its own software hangs: /dev/watchdog, systemd, or a circuit
/// of the board.

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::hal {

/// | state    | arm   | feed    | disarm   | destroyed |
/// |----------|-------|---------|----------|-----------|
/// | Disarmed | Armed | refused | Disarmed | Disarmed  |
/// | Armed    | Armed | Armed   | Disarmed | stays armed: a crash must be noticed |
///
/// refused: Errc::WrongState.  Thread: one owner.  RT: feed() is one system call.
class Watchdog {
 public:
  Watchdog() = default;
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;
  virtual ~Watchdog() = default;

  /// Gives back the timeout that the device really uses (whole seconds on many).
  [[nodiscard]] virtual Result<Nanoseconds> arm(Nanoseconds timeout) = 0;
  [[nodiscard]] virtual Result<void> feed() noexcept = 0;
  [[nodiscard]] virtual Result<void> disarm() = 0;
};

}  // namespace biteline::hal
