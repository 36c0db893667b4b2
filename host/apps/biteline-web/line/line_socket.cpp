// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/line/line_socket.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <array>
#include <cerrno>
#include <optional>

namespace biteline::web {
namespace {

constexpr int k_backlog = 16;

struct Address {
  sockaddr_storage storage{};
  socklen_t size{0};
  bool loopback{false}, every{false};
};

std::optional<Address> address_of(const std::string& text, std::uint16_t port) {
  Address out;
  in_addr four{};
  in6_addr six{};
  if (::inet_pton(AF_INET, text.c_str(), &four) == 1) {
    auto& address = reinterpret_cast<sockaddr_in&>(out.storage);
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr = four;
    out.size = sizeof(sockaddr_in);
    out.loopback = ntohl(four.s_addr) >> 24 == 127;
    out.every = four.s_addr == htonl(INADDR_ANY);
    return out;
  }
  if (::inet_pton(AF_INET6, text.c_str(), &six) == 1) {
    auto& address = reinterpret_cast<sockaddr_in6&>(out.storage);
    address.sin6_family = AF_INET6;
    address.sin6_port = htons(port);
    address.sin6_addr = six;
    out.size = sizeof(sockaddr_in6);
    out.loopback = IN6_IS_ADDR_LOOPBACK(&six);
    out.every = IN6_IS_ADDR_UNSPECIFIED(&six);
    return out;
  }
  return std::nullopt;
}

}  // namespace

std::string text_of(const sockaddr_storage& storage) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const void* bytes =
      storage.ss_family == AF_INET6
          ? static_cast<const void*>(&reinterpret_cast<const sockaddr_in6&>(storage).sin6_addr)
          : &reinterpret_cast<const sockaddr_in&>(storage).sin_addr;
  return ::inet_ntop(storage.ss_family, bytes, text.data(), text.size()) == nullptr ? "" : text.data();
}

std::string text_of_address(const std::string& typed) {
  const std::optional<Address> address = address_of(typed, 0);
  return address ? text_of(address->storage) : std::string{};
}

Result<Listening> listen_for_line(const LineListener& at, bool peers_are_listed, const char* option) {
  Listening listening;
  const std::optional<Address> address = address_of(at.address, at.port);
  if (!address) {
    return fail(Errc::InvalidArgument, "%s %.60s: the number of one interface expected, e.g. 127.0.0.1",
                option, at.address.c_str());
  }
  if (address->every || (!address->loopback && !peers_are_listed)) {
    return fail(Errc::AuthenticationFailed,
                "%s %.60s has no login: name one interface, and beyond loopback each peer with --line-peer",
                option, at.address.c_str());
  }
  listening.socket =
      Socket{::socket(address->storage.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  const int fd = listening.socket.get();
  const int yes = 1;
  ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  if (fd < 0 || ::bind(fd, reinterpret_cast<const sockaddr*>(&address->storage), address->size) != 0 ||
      ::listen(fd, k_backlog) != 0 || ::getsockname(fd, reinterpret_cast<sockaddr*>(&bound), &size) != 0) {
    return fail_errno(Errc::PeerRefused, errno, "%s %.60s port %u: cannot listen there; choose another",
                      option, at.address.c_str(), unsigned{at.port});
  }
  listening.port = ntohs(bound.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(bound).sin6_port
                                                     : reinterpret_cast<sockaddr_in&>(bound).sin_port);
  return listening;
}

}  // namespace biteline::web
