// SPDX-License-Identifier: MIT
#include "hal/sim/robot/udp_sender.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>

namespace biteline::sim {

Result<UdpSender> UdpSender::open(std::uint16_t port) {
  hal::Descriptor socket{::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  if (!socket.is_open()) return hal::device_failure(errno, "UDP", "socket");
  return UdpSender{std::move(socket), port};
}

void UdpSender::send(std::span<const std::uint8_t> bytes) const {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port_);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  static_cast<void>(::sendto(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL,
                             reinterpret_cast<const sockaddr*>(&address), sizeof address));
}

std::optional<std::string> UdpSender::receive() const {
  std::array<char, 1024> bytes{};
  const ssize_t size = ::recv(socket_.number(), bytes.data(), bytes.size(), 0);
  if (size < 0) return std::nullopt;
  return std::string{bytes.data(), static_cast<std::size_t>(size)};
}

}  // namespace biteline::sim
