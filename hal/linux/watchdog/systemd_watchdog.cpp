// SPDX-License-Identifier: MIT
#include "hal/linux/watchdog/systemd_watchdog.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

namespace biteline::hal {

Result<std::unique_ptr<SystemdWatchdog>> SystemdWatchdog::open_from_environment() {
  const char* address = std::getenv("NOTIFY_SOCKET");
  if (address == nullptr)
    return fail(Errc::DeviceNotFound, "NOTIFY_SOCKET: not started by systemd (Type=notify)");
  return open(address);
}

Result<std::unique_ptr<SystemdWatchdog>> SystemdWatchdog::open(const std::string& socket_address) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (socket_address.size() < 2 || socket_address.size() >= sizeof name.sun_path) {
    return fail(Errc::BadValue, "NOTIFY_SOCKET %.60s", socket_address.c_str());
  }
  std::copy(socket_address.begin(), socket_address.end(), name.sun_path);
  if (name.sun_path[0] == '@') name.sun_path[0] = '\0';  // abstract, as sd_notify(3) has it
  Descriptor socket{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_address.size());
  if (!socket.is_open() || ::connect(socket.number(), reinterpret_cast<const sockaddr*>(&name), size) < 0) {
    return device_failure(errno, socket_address.c_str(), "connect to systemd");
  }
  return std::unique_ptr<SystemdWatchdog>{new SystemdWatchdog{std::move(socket)}};
}

Result<Nanoseconds> SystemdWatchdog::arm(Nanoseconds timeout) {
  if (timeout <= Nanoseconds{0}) return fail(Errc::BadValue, "watchdog timeout");
  const auto timeout_us = std::chrono::ceil<std::chrono::microseconds>(timeout);
  const auto text = FixedText<80>::format("READY=1\nWATCHDOG=1\nWATCHDOG_USEC=%lld",
                                          static_cast<long long>(timeout_us.count()));
  BITELINE_TRY(tell(text.view()));
  armed_ = true;
  return timeout_us;
}

Result<void> SystemdWatchdog::feed() noexcept {
  if (!armed_) return fail(Errc::WrongState, "watchdog fed before it was armed");
  return tell("WATCHDOG=1");
}

Result<void> SystemdWatchdog::disarm() {
  if (!armed_) return {};
  BITELINE_TRY(tell("WATCHDOG_USEC=0"));
  armed_ = false;
  return {};
}

Result<void> SystemdWatchdog::tell(std::string_view text) noexcept {
  if (::send(socket_.number(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT) < 0) {
    if (errno == EAGAIN) return fail_errno(Errc::Overrun, errno, "systemd does not read its notifications");
    if (errno == ECONNREFUSED || errno == ENOENT)
      return fail_errno(Errc::DeviceLost, errno, "systemd's socket");
    return device_failure(errno, "systemd", "notify");
  }
  return {};
}

}  // namespace biteline::hal
