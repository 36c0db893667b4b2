// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/tcp_stream.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <utility>

namespace biteline::robot::ur {
namespace {

constexpr std::size_t k_read_bytes = 16384;

int to_poll_ms(Nanoseconds patience) {
  const auto ms = (patience.count() + 999'999) / 1'000'000;
  return static_cast<int>(std::clamp<std::int64_t>(ms, 0, 1'000'000));
}

/// Waits for `events`; false after `patience`.
bool wait_for(int socket, short events, Nanoseconds patience) {
  pollfd entry{.fd = socket, .events = events, .revents = 0};
  int ready = 0;
  do {
    ready = poll(&entry, 1, to_poll_ms(patience));
  } while (ready < 0 && errno == EINTR);
  return ready > 0;
}

}  // namespace

Result<TcpStream> TcpStream::begin(const Endpoint& endpoint) {
  const std::string peer = endpoint.host + ":" + std::to_string(endpoint.port);
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int code =
          getaddrinfo(endpoint.host.c_str(), std::to_string(endpoint.port).c_str(), &hints, &found);
      code != 0) {
    return fail(Errc::ConnectFailed, "%.100s: %s", peer.c_str(), gai_strerror(code));
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses{found, &freeaddrinfo};

  TcpStream stream;
  stream.peer_ = peer;
  stream.socket_ = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (stream.socket_ < 0) return fail_errno(Errc::ConnectFailed, errno, "%.100s", peer.c_str());
  // States are small and urgent.
  const int on = 1;
  static_cast<void>(setsockopt(stream.socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on));
  if (::connect(stream.socket_, found->ai_addr, found->ai_addrlen) != 0 && errno != EINPROGRESS)
    return fail_errno(Errc::ConnectFailed, errno, "%.100s", peer.c_str());
  return stream;
}

Result<TcpStream> TcpStream::connect(const Endpoint& endpoint, Nanoseconds patience) {
  BITELINE_ASSIGN(TcpStream stream, begin(endpoint));
  if (!wait_for(stream.socket_, POLLOUT, patience))
    return fail(Errc::Timeout, "%.100s: connecting", stream.peer_.c_str());
  int code = 0;
  socklen_t size = sizeof code;
  if (getsockopt(stream.socket_, SOL_SOCKET, SO_ERROR, &code, &size) != 0 || code != 0)
    return fail_errno(Errc::ConnectFailed, code, "%.100s", stream.peer_.c_str());
  return stream;
}

TcpStream::TcpStream(TcpStream&& other) noexcept
    : socket_{std::exchange(other.socket_, -1)}, peer_{std::move(other.peer_)} {}

TcpStream& TcpStream::operator=(TcpStream&& other) noexcept {
  if (this != &other) {
    close();
    socket_ = std::exchange(other.socket_, -1);
    peer_ = std::move(other.peer_);
  }
  return *this;
}

TcpStream::~TcpStream() {
  close();
}

void TcpStream::close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

Result<void> TcpStream::write_all(std::span<const std::uint8_t> bytes, Nanoseconds patience) {
  while (!bytes.empty()) {
    const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    } else if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      if (!wait_for(socket_, POLLOUT, patience)) return fail(Errc::Timeout, "%.100s: sending", peer_.c_str());
    } else if (sent < 0 && errno != EINTR) {
      return fail_errno(Errc::ConnectionLost, errno, "%.100s: sending", peer_.c_str());
    }
  }
  return {};
}

Result<void> TcpStream::write_all(std::string_view text, Nanoseconds patience) {
  return write_all(std::span{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, patience);
}

Result<std::size_t> TcpStream::write_now(std::string_view text) {
  while (true) {
    const ssize_t sent = send(socket_, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0) return static_cast<std::size_t>(sent);
    if (errno == EAGAIN || errno == EWOULDBLOCK) return std::size_t{0};
    if (errno != EINTR) return fail_errno(Errc::ConnectionLost, errno, "%.100s: sending", peer_.c_str());
  }
}

bool TcpStream::take_now(std::vector<std::uint8_t>& bytes) {
  // A controller may send faster than this reads; what is more than so much is read the next time.
  constexpr int k_most_reads = 64;
  std::uint8_t some[k_read_bytes];
  for (int i = 0; is_open() && i < k_most_reads; ++i) {
    const ssize_t got = recv(socket_, some, sizeof some, MSG_DONTWAIT);
    if (got > 0) bytes.insert(bytes.end(), some, some + got);
    if (got > 0 || (got < 0 && errno == EINTR)) continue;
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
    close();
  }
  return is_open();
}

bool TcpStream::lives() {
  std::vector<std::uint8_t> dropped;
  return take_now(dropped);
}

Endpoint TcpStream::numeric_peer() const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  char host[NI_MAXHOST], port[NI_MAXSERV];
  if (getpeername(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
      getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, host, sizeof host, port, sizeof port,
                  NI_NUMERICHOST | NI_NUMERICSERV) != 0)
    return {};
  return {.host = host, .port = static_cast<std::uint16_t>(std::strtoul(port, nullptr, 10))};
}

bool wait_for_room(std::span<const int> sockets, Nanoseconds patience) {
  std::vector<pollfd> entries;
  for (const int socket : sockets) entries.push_back({.fd = socket, .events = POLLOUT, .revents = 0});
  return poll(entries.data(), entries.size(), to_poll_ms(patience)) > 0;
}

Result<void> TcpStream::read_some(std::vector<std::uint8_t>& bytes, Nanoseconds patience) {
  bytes.clear();
  if (!wait_for(socket_, POLLIN, patience)) return {};
  bytes.resize(k_read_bytes);
  const ssize_t got = recv(socket_, bytes.data(), bytes.size(), 0);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
    bytes.clear();
    return {};
  }
  if (got <= 0) {
    bytes.clear();
    return fail_errno(Errc::ConnectionLost, got < 0 ? errno : 0, "%.100s: receiving", peer_.c_str());
  }
  bytes.resize(static_cast<std::size_t>(got));
  return {};
}

}  // namespace biteline::robot::ur
