// SPDX-License-Identifier: MIT
#include "hal/linux/rtde/tcp_stream.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace biteline::hal {

void wait_for(int number, short events, Nanoseconds timeout) {
  const Nanoseconds bounded = std::max(timeout, Nanoseconds{0});
  const std::timespec limit{.tv_sec = bounded.count() / 1'000'000'000,
                            .tv_nsec = bounded.count() % 1'000'000'000};
  pollfd watched{.fd = number, .events = events, .revents = 0};
  static_cast<void>(::ppoll(&watched, 1, &limit, nullptr));
}

Result<TcpStream> TcpStream::connect(const Peer& peer) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(peer.port);
  if (::inet_pton(AF_INET, peer.address.c_str(), &address.sin_addr) != 1) {
    return fail(Errc::BadValue, "%.60s is no IPv4 address", peer.address.c_str());
  }
  Descriptor socket{::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  if (!socket.is_open()) return device_failure(errno, peer.address.c_str(), "socket");
  const int on = 1;
  ::setsockopt(socket.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (::connect(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) < 0 &&
      errno != EINPROGRESS) {
    return fail_errno(Errc::ConnectFailed, errno, "%.60s:%d", peer.address.c_str(), int{peer.port});
  }
  return TcpStream{std::move(socket), peer.address};
}

Result<bool> TcpStream::connected() {
  if (connected_) return true;
  pollfd watched{.fd = socket_.number(), .events = POLLOUT, .revents = 0};
  if (::poll(&watched, 1, 0) <= 0) return false;
  int fault = 0;
  socklen_t size = sizeof fault;
  ::getsockopt(socket_.number(), SOL_SOCKET, SO_ERROR, &fault, &size);
  if (fault != 0) return fail_errno(Errc::ConnectFailed, fault, "%.60s", name_.c_str());
  connected_ = true;
  return true;
}

Result<void> TcpStream::send(std::vector<std::uint8_t>& bytes) {
  if (bytes.empty()) return {};
  const ssize_t sent = ::send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (sent < 0) {
    if (errno == EAGAIN || errno == EINTR) return {};
    return fail_errno(Errc::ConnectionLost, errno, "%.60s", name_.c_str());
  }
  bytes.erase(bytes.begin(), bytes.begin() + sent);
  return {};
}

Result<std::span<const std::uint8_t>> TcpStream::receive(std::span<std::uint8_t> buffer) {
  const ssize_t size = ::recv(socket_.number(), buffer.data(), buffer.size(), 0);
  if (size > 0) return buffer.first(static_cast<std::size_t>(size));
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return std::span<const std::uint8_t>{};
  return fail_errno(Errc::ConnectionLost, size < 0 ? errno : 0, "%.60s", name_.c_str());
}

}  // namespace biteline::hal
