// SPDX-License-Identifier: MIT
#include "common/wire/socket.hpp"

#include <zmq.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace biteline::wire {
namespace {

constexpr std::size_t k_max_parts = 8;
/// Longest wait at the end for packets that have not left yet (a farewell).
constexpr int k_linger_ms = 300;

int native_kind(SocketKind kind) {
  switch (kind) {
    case SocketKind::Listener:
      return ZMQ_ROUTER;
    case SocketKind::Caller:
      return ZMQ_DEALER;
    case SocketKind::Gatekeeper:
      return ZMQ_REP;
    case SocketKind::Watcher:
      return ZMQ_PAIR;
  }
  return ZMQ_PAIR;
}

}  // namespace

Result<SocketContext> SocketContext::create() {
  void* handle = zmq_ctx_new();
  if (handle == nullptr) return fail_errno(Errc::DeviceError, zmq_errno(), "zmq_ctx_new");
  return SocketContext{handle};
}

SocketContext::SocketContext(SocketContext&& other) noexcept
    : handle_{std::exchange(other.handle_, nullptr)} {}

SocketContext::~SocketContext() {
  if (handle_ == nullptr) return;
  while (zmq_ctx_term(handle_) != 0 && zmq_errno() == EINTR) {
  }
}

Result<Socket> Socket::open(const SocketContext& context, SocketKind kind) {
  Socket socket{zmq_socket(context.handle(), native_kind(kind))};
  if (socket.handle_ == nullptr) return fail_errno(Errc::DeviceError, zmq_errno(), "zmq_socket");
  BITELINE_TRY(socket.set(ZMQ_LINGER, k_linger_ms));
  return socket;
}

Socket::Socket(Socket&& other) noexcept : handle_{std::exchange(other.handle_, nullptr)} {}

Socket& Socket::operator=(Socket&& other) noexcept {
  std::swap(handle_, other.handle_);
  return *this;
}

Socket::~Socket() {
  if (handle_ != nullptr) zmq_close(handle_);
}

Result<void> Socket::set(int option, int value) {
  if (zmq_setsockopt(handle_, option, &value, sizeof value) == 0) return {};
  return fail_errno(Errc::DeviceError, zmq_errno(), "zmq_setsockopt %d", option);
}

Result<void> Socket::set(int option, const std::string& value) {
  if (zmq_setsockopt(handle_, option, value.data(), value.size()) == 0) return {};
  return fail_errno(Errc::DeviceError, zmq_errno(), "zmq_setsockopt %d", option);
}

Result<void> Socket::bind(const std::string& address) {
  if (zmq_bind(handle_, address.c_str()) == 0) return {};
  return fail_errno(Errc::ConnectFailed, zmq_errno(), "listening at %s", address.c_str());
}

void Socket::unbind(const std::string& address) {
  static_cast<void>(zmq_unbind(handle_, address.c_str()));  // not bound is what is wanted
}

Result<void> Socket::connect(const std::string& address) {
  if (zmq_connect(handle_, address.c_str()) == 0) return {};
  return fail_errno(Errc::ConnectFailed, zmq_errno(), "connecting to %s", address.c_str());
}

Result<std::string> Socket::bound_address() const {
  char address[256] = {};
  std::size_t size = sizeof address;
  if (zmq_getsockopt(handle_, ZMQ_LAST_ENDPOINT, address, &size) != 0) {
    return fail_errno(Errc::DeviceError, zmq_errno(), "zmq_getsockopt LAST_ENDPOINT");
  }
  return std::string{address};
}

bool Socket::send(std::initializer_list<std::span<const std::uint8_t>> parts) {
  std::size_t left = parts.size();
  for (const auto part : parts) {
    --left;
    const int more = left > 0 ? ZMQ_SNDMORE : 0;
    int sent = -1;
    do {
      sent = zmq_send(handle_, part.data(), part.size(), ZMQ_DONTWAIT | more);
    } while (sent < 0 && zmq_errno() == EINTR);
    // Only the first part can fail for want of room or of a peer: libzmq takes messages whole.
    if (sent < 0) return false;
  }
  return true;
}

std::optional<Socket::Parts> Socket::receive() {
  Parts message;
  bool more = true;
  while (more) {
    zmq_msg_t part;
    zmq_msg_init(&part);
    int size = -1;
    do {
      size = zmq_msg_recv(&part, handle_, ZMQ_DONTWAIT);
    } while (size < 0 && zmq_errno() == EINTR);
    if (size < 0) {
      zmq_msg_close(&part);
      return std::nullopt;
    }
    if (message.parts.size() < k_max_parts) {
      const auto* data = static_cast<const std::uint8_t*>(zmq_msg_data(&part));
      message.parts.emplace_back(data, data + size);
    } else {
      ++message.surplus_parts;
    }
    more = zmq_msg_more(&part) != 0;
    zmq_msg_close(&part);
  }
  return message;
}

void wait_readable(std::initializer_list<const Socket*> sockets, Nanoseconds timeout) {
  std::vector<zmq_pollitem_t> items;
  for (const Socket* socket : sockets)
    items.push_back({.socket = socket->handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0});
  const auto timeout_ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  // A signal ends the wait early, which is what the caller's loop wants.
  zmq_poll(items.data(), static_cast<int>(items.size()), static_cast<long>(timeout_ms));
}

}  // namespace biteline::wire
