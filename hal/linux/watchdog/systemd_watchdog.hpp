// SPDX-License-Identifier: MIT
#pragma once
/// \file Watchdog kept by systemd (WatchdogSec= of the unit), which kills and restarts the process.
///
/// The protocol of sd_notify(3): one datagram on the socket that $NOTIFY_SOCKET names.  Spoken here and not
/// by libsystemd, because sd_notify() allocates and connects anew at every call and feed() runs beside the
/// frame loop.

#include <memory>
#include <string>
#include <string_view>

#include "hal/api/watchdog.hpp"
#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {

class SystemdWatchdog final : public Watchdog {
 public:
  /// Errc::DeviceNotFound when the process was not started by systemd with notification.
  [[nodiscard]] static Result<std::unique_ptr<SystemdWatchdog>> open_from_environment();
  [[nodiscard]] static Result<std::unique_ptr<SystemdWatchdog>> open(const std::string& socket_address);

  /// Tells systemd the timeout (WATCHDOG_USEC), and that the unit is ready.
  [[nodiscard]] Result<Nanoseconds> arm(Nanoseconds timeout) override;
  /// Errc::Overrun when systemd does not read; never waits.
  [[nodiscard]] Result<void> feed() noexcept override;
  /// There is no way to stop it but a timeout that never comes: WATCHDOG_USEC=0 turns it off.
  [[nodiscard]] Result<void> disarm() override;

 private:
  explicit SystemdWatchdog(Descriptor socket) : socket_{std::move(socket)} {}
  Result<void> tell(std::string_view text) noexcept;

  Descriptor socket_;
  bool armed_{false};
};

}  // namespace biteline::hal
