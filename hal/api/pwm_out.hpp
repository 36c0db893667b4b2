// SPDX-License-Identifier: MIT
#pragma once
/// \file A hardware pulse train: the camera's trigger (and the laser's power, on heads that dim it).

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::hal {

struct PwmSettings {
  Nanoseconds period{0};
  Nanoseconds pulse{0};  ///< active part of each period, <= period
};

/// | state   | configure | start   | stop    |
/// |---------|-----------|---------|---------|
/// | Opened  | Stopped   | refused | Opened  |
/// | Stopped | Stopped   | Running | Stopped |
/// | Running | Running   | Running | Stopped |
///
/// refused: Errc::WrongState.  Output inactive in every state but Running, and when the object goes.
/// Thread: one owner.
class PwmOut {
 public:
  PwmOut() = default;
  PwmOut(const PwmOut&) = delete;
  PwmOut& operator=(const PwmOut&) = delete;
  virtual ~PwmOut() = default;

  /// Gives back what the hardware's divider made of it; Errc::BadValue when that is off by more than 1 %.
  /// A running train changes at a period's border.
  [[nodiscard]] virtual Result<PwmSettings> configure(const PwmSettings& wanted) = 0;
  [[nodiscard]] virtual Result<void> start() = 0;
  [[nodiscard]] virtual Result<void> stop() noexcept = 0;
  [[nodiscard]] virtual bool running() const noexcept = 0;
  /// false: a thread toggles a line (SoftwarePwm); its jitter is the scheduler's, and health says so.
  [[nodiscard]] virtual bool hardware_timed() const noexcept { return true; }
};

}  // namespace biteline::hal
