// SPDX-License-Identifier: MIT
#include "hal/linux/posix/descriptor.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <ctime>

namespace biteline::hal {
namespace {

Errc code_of(int sys_errno) {
  switch (sys_errno) {
    case ENOENT:
    case ENXIO:
      return Errc::DeviceNotFound;
    case ENODEV:
    case EPIPE:
    case ENETDOWN:
    case ENETUNREACH:
      return Errc::DeviceLost;
    case EACCES:
    case EPERM:
      return Errc::NoRights;
    case ENOTTY:
    case EOPNOTSUPP:
    case ENOSYS:
      return Errc::NotSupported;
    case EINVAL:
    case ERANGE:
      return Errc::BadValue;
    case ENOBUFS:
      return Errc::Overrun;
    default:
      return Errc::DeviceError;
  }
}

std::timespec to_timespec(Nanoseconds duration) {
  constexpr std::int64_t k_ns_per_s = 1'000'000'000;
  return {.tv_sec = duration.count() / k_ns_per_s, .tv_nsec = duration.count() % k_ns_per_s};
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    close();
    number_ = std::exchange(other.number_, -1);
  }
  return *this;
}

void Descriptor::close() noexcept {
  // Linux frees the number even when close() reports EINTR; a second close could hit another thread's new
  // file.
  if (number_ >= 0) ::close(std::exchange(number_, -1));
}

tl::unexpected<Error> device_failure(int sys_errno, const char* device, const char* call) {
  return fail_errno(code_of(sys_errno), sys_errno, "%.120s: %.80s", device, call);
}

Result<Descriptor> open_device(const char* path, int flags) {
  const int number = ::open(path, flags | O_CLOEXEC);
  if (number < 0) return device_failure(errno, path, "open");
  return Descriptor{number};
}

int retrying_ioctl(int number, unsigned long request, void* argument) noexcept {
  int result = -1;
  do {
    result = ::ioctl(number, request, argument);
  } while (result < 0 && errno == EINTR);
  return result;
}

Result<void> wait_readable(int number, Nanoseconds timeout, const char* device) {
  const SensorClock::time_point deadline = monotonic_now() + std::max(timeout, Nanoseconds{0});
  while (true) {
    const Nanoseconds left = std::max(deadline - monotonic_now(), Nanoseconds{0});
    pollfd watched{.fd = number, .events = POLLIN, .revents = 0};
    const std::timespec limit = to_timespec(left);
    const int ready = ::ppoll(&watched, 1, &limit, nullptr);
    if (ready > 0) return {};
    if (ready == 0) return fail(Errc::Timeout, "%.120s", device);
    if (errno != EINTR) return device_failure(errno, device, "poll");
  }
}

SensorClock::time_point monotonic_now() noexcept {
  std::timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return SensorClock::time_point{Nanoseconds{std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec}};
}

Result<void> write_text(const char* path, std::string_view text) {
  BITELINE_ASSIGN(const Descriptor file, open_device(path, O_WRONLY));
  const ssize_t written = ::write(file.number(), text.data(), text.size());
  if (written < 0) return device_failure(errno, path, "write");
  if (written != static_cast<ssize_t>(text.size()))
    return fail(Errc::DeviceError, "%.120s: short write", path);
  return {};
}

Result<std::int64_t> read_integer(const char* path) {
  BITELINE_ASSIGN(const Descriptor file, open_device(path, O_RDONLY));
  std::array<char, 32> text{};
  const ssize_t size = ::read(file.number(), text.data(), text.size());
  if (size < 0) return device_failure(errno, path, "read");
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + size, value);
  if (fault != std::errc{}) return fail(Errc::BadFormat, "%.120s: a number expected", path);
  return value;
}

}  // namespace biteline::hal
