// SPDX-License-Identifier: MIT
#include "hal/sim/robot/tcp.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>

namespace biteline::sim {

Result<TcpListener> listen_on_loopback(std::uint16_t port) {
  TcpListener listener{
      .socket = hal::Descriptor(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)),
      .port = port};
  const int number = listener.socket.number();
  if (number < 0) return fail_errno(Errc::DeviceError, errno, "socket");
  const int on = 1;
  setsockopt(number, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (bind(number, generic, size) != 0 || listen(number, 8) != 0 ||
      getsockname(number, generic, &size) != 0) {
    return fail_errno(Errc::ConnectFailed, errno, "127.0.0.1:%d", int{port});
  }
  listener.port = ntohs(address.sin_port);
  return listener;
}

hal::Descriptor accept_from(const TcpListener& listener) {
  hal::Descriptor client(accept4(listener.socket.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  const int on = 1;
  // Controllers send small packages each cycle; gathering them would shift their time.
  if (client.is_open()) setsockopt(client.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return client;
}

bool read_available(const hal::Descriptor& socket, std::vector<std::uint8_t>& bytes) {
  for (;;) {
    std::uint8_t piece[4096];
    const auto size = recv(socket.number(), piece, sizeof piece, MSG_DONTWAIT);
    if (size > 0) {
      bytes.insert(bytes.end(), piece, piece + size);
      continue;
    }
    if (size < 0 && errno == EINTR) continue;
    return size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
  }
}

bool write_available(const hal::Descriptor& socket, std::vector<std::uint8_t>& bytes) {
  std::size_t sent = 0;
  bool alive = true;
  while (sent < bytes.size()) {
    const auto size =
        send(socket.number(), bytes.data() + sent, bytes.size() - sent, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) {
      alive = errno == EAGAIN || errno == EWOULDBLOCK;
      break;
    }
    sent += static_cast<std::size_t>(size);
  }
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(sent));
  return alive;
}

}  // namespace biteline::sim
