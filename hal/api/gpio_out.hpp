// SPDX-License-Identifier: MIT
#pragma once
/// \file One output line: laser enable, indicator, software trigger.

#include "common/core/result.hpp"

namespace biteline::hal {

/// Made by the backend's open(); the line starts inactive and falls back to inactive when the object goes,
/// when the process dies (where the kernel's driver gives the line back to its pull: boards/README.md), and
/// by the board's pull before start-up. Active-low wiring is the backend's affair: `true` is always the named
/// function on.
///
/// | state    | set(true) | set(false) | destroyed |
/// |----------|-----------|------------|-----------|
/// | inactive | active    | inactive   | inactive  |
/// | active   | active    | inactive   | inactive  |
///
/// Thread: any, calls are serialised by the kernel.  RT: one system call, no allocation.
class GpioOut {
 public:
  GpioOut() = default;
  GpioOut(const GpioOut&) = delete;
  GpioOut& operator=(const GpioOut&) = delete;
  virtual ~GpioOut() = default;

  /// Errc::DeviceError or DeviceLost: the level is then unknown, and the caller must treat it as active.
  [[nodiscard]] virtual Result<void> set(bool active) noexcept = 0;

  /// The level as the hardware reports it, not as it was last asked for.
  [[nodiscard]] virtual Result<bool> read_back() noexcept = 0;
};

}  // namespace biteline::hal
