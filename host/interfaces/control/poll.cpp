// SPDX-License-Identifier: MIT
#include "host/interfaces/control/poll.hpp"

#include <sys/eventfd.h>
#include <unistd.h>
#include <zmq.h>

#include <cerrno>
#include <utility>

namespace biteline::control {

Result<Wake> Wake::create() {
  const int fd = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (fd < 0) return fail_errno(Errc::DeviceError, errno, "eventfd");
  return Wake{fd};
}

Wake::Wake(Wake&& other) noexcept : fd_{std::exchange(other.fd_, -1)} {}

Wake::~Wake() {
  if (fd_ >= 0) ::close(fd_);
}

void Wake::ring() const {
  // A counter that is full is rung already.
  static_cast<void>(::eventfd_write(fd_, 1));
}

void Wake::silence() const {
  eventfd_t rung = 0;
  static_cast<void>(::eventfd_read(fd_, &rung));
}

void wait_for(std::initializer_list<const wire::Socket*> sockets, const Wake& wake, Nanoseconds timeout) {
  std::vector<zmq_pollitem_t> items{
      {.socket = nullptr, .fd = wake.handle(), .events = ZMQ_POLLIN, .revents = 0}};
  for (const wire::Socket* socket : sockets)
    items.push_back({.socket = socket->handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0});
  const auto timeout_ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  zmq_poll(items.data(), static_cast<int>(items.size()), static_cast<long>(timeout_ms));
  wake.silence();
}

}  // namespace biteline::control
