// SPDX-License-Identifier: MIT
#pragma once
/// \file Watchdog on /dev/watchdog: the hardware timer that resets the board.

#include <memory>
#include <string>

#include "hal/api/watchdog.hpp"
#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {

/// The kernel arms the timer when the device is opened, so it is opened by arm() and not before.
class KernelWatchdog final : public Watchdog {
 public:
  /// Checks that the device exists without touching it.
  [[nodiscard]] static Result<std::unique_ptr<KernelWatchdog>> open(const std::string& path);

  /// Whole seconds, rounded up.
  [[nodiscard]] Result<Nanoseconds> arm(Nanoseconds timeout) override;
  [[nodiscard]] Result<void> feed() noexcept override;
  /// Errc::Refused where the driver was built to never stop (nowayout).
  [[nodiscard]] Result<void> disarm() override;

 private:
  explicit KernelWatchdog(const std::string& path) : path_{path} {}

  std::string path_;
  Descriptor device_;  ///< open: armed
};

}  // namespace biteline::hal
