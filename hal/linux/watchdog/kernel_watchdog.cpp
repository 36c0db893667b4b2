// SPDX-License-Identifier: MIT
#include "hal/linux/watchdog/kernel_watchdog.hpp"

#include <fcntl.h>
#include <linux/watchdog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace biteline::hal {

Result<std::unique_ptr<KernelWatchdog>> KernelWatchdog::open(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) < 0) return device_failure(errno, path.c_str(), "watchdog");
  if (!S_ISCHR(status.st_mode)) return fail(Errc::DeviceNotFound, "%.100s: no watchdog device", path.c_str());
  return std::unique_ptr<KernelWatchdog>{new KernelWatchdog{path}};
}

Result<Nanoseconds> KernelWatchdog::arm(Nanoseconds timeout) {
  if (timeout <= Nanoseconds{0}) return fail(Errc::BadValue, "watchdog timeout");
  if (!device_.is_open()) {
    BITELINE_ASSIGN(device_, open_device(path_.c_str(), O_WRONLY));
  }
  int seconds = static_cast<int>(std::chrono::ceil<std::chrono::seconds>(timeout).count());
  if (retrying_ioctl(device_.number(), WDIOC_SETTIMEOUT, &seconds) < 0) {
    if (errno != ENOTTY && errno != EOPNOTSUPP) return device_failure(errno, path_.c_str(), "set timeout");
    // A fixed timer: use its own.
    if (retrying_ioctl(device_.number(), WDIOC_GETTIMEOUT, &seconds) < 0) {
      return device_failure(errno, path_.c_str(), "get timeout");
    }
  }
  BITELINE_TRY(feed());
  return std::chrono::seconds{seconds};
}

Result<void> KernelWatchdog::feed() noexcept {
  if (!device_.is_open()) return fail(Errc::WrongState, "watchdog fed before it was armed");
  if (retrying_ioctl(device_.number(), WDIOC_KEEPALIVE, nullptr) < 0) {
    return device_failure(errno, path_.c_str(), "feed");
  }
  return {};
}

Result<void> KernelWatchdog::disarm() {
  if (!device_.is_open()) return {};
  int option = WDIOS_DISABLECARD;
  const bool stopped = retrying_ioctl(device_.number(), WDIOC_SETOPTIONS, &option) == 0;
  // The magic close: without this letter the driver goes on counting after close().
  const bool written = ::write(device_.number(), "V", 1) == 1;
  device_.close();
  if (!stopped && !written) return fail(Errc::Refused, "%.100s cannot be stopped", path_.c_str());
  return {};
}

}  // namespace biteline::hal
