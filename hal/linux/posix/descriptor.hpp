// SPDX-License-Identifier: MIT
#pragma once
/// \file What every kernel backend needs: an owned file descriptor, a bounded wait, and errno as an Error.

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::hal {

/// The one owner of a file descriptor.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) noexcept : number_{number} {}
  Descriptor(Descriptor&& other) noexcept : number_{std::exchange(other.number_, -1)} {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor() { close(); }

  [[nodiscard]] int number() const noexcept { return number_; }
  [[nodiscard]] bool is_open() const noexcept { return number_ >= 0; }
  void close() noexcept;

 private:
  int number_{-1};
};

/// The funnel for errno: `call` failed on `device`.  What a missing node, a pulled plug, a lack of rights, a
/// busy device and a request that the driver does not know become is decided here and nowhere else.
[[nodiscard]] tl::unexpected<Error> device_failure(int sys_errno, const char* device, const char* call);

[[nodiscard]] Result<Descriptor> open_device(const char* path, int flags);

/// ioctl that goes on after a signal.  -1 and errno as ioctl has it.
int retrying_ioctl(int number, unsigned long request, void* argument) noexcept;

/// Until `number` is readable; Errc::Timeout otherwise.  A negative timeout does not wait.
/// POLLERR and POLLHUP are left to the read that follows: only it knows the errno.
[[nodiscard]] Result<void> wait_readable(int number, Nanoseconds timeout, const char* device);

/// CLOCK_MONOTONIC, which is the sensor's clock on a unit.
[[nodiscard]] SensorClock::time_point monotonic_now() noexcept;

/// One whole small text into a file, as sysfs wants it, and the first line out of one.
[[nodiscard]] Result<void> write_text(const char* path, std::string_view text);
[[nodiscard]] Result<std::int64_t> read_integer(const char* path);

}  // namespace biteline::hal
