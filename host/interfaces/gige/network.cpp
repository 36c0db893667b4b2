// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/network.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <memory>

#include "common/gige/bootstrap.hpp"
#include "common/gige/packets.hpp"

namespace biteline::gige {
namespace {

std::uint32_t ipv4_of(const sockaddr* address) {
  return address == nullptr ? 0 : ntohl(reinterpret_cast<const sockaddr_in*>(address)->sin_addr.s_addr);
}

bool same_network(std::uint32_t one, std::uint32_t other, std::uint32_t mask) {
  return (one & mask) == (other & mask);
}

}  // namespace

std::optional<std::uint32_t> read_address(const std::string& text) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1) return std::nullopt;
  return ntohl(address.s_addr);
}

std::string address_text(std::uint32_t address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  const in_addr raw{.s_addr = htonl(address)};
  inet_ntop(AF_INET, &raw, text.data(), text.size());
  return text.data();
}

Result<std::vector<Interface>> interfaces() {
  ifaddrs* raw = nullptr;
  if (getifaddrs(&raw) != 0) return fail_errno(Errc::DeviceError, errno, "getifaddrs");
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> list{raw, &freeifaddrs};
  std::vector<Interface> found;
  for (const ifaddrs* one = raw; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    found.push_back({.name = one->ifa_name,
                     .address = ipv4_of(one->ifa_addr),
                     .mask = ipv4_of(one->ifa_netmask),
                     .loopback = (one->ifa_flags & IFF_LOOPBACK) != 0});
  }
  for (const ifaddrs* one = raw; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_PACKET) continue;
    const auto* link = reinterpret_cast<const sockaddr_ll*>(one->ifa_addr);
    for (Interface& interface : found)
      if (interface.name == one->ifa_name) std::copy_n(link->sll_addr, 6, interface.mac.begin());
  }
  return found;
}

Result<Interface> choose_interface(const std::vector<Interface>& all, const std::string& wanted) {
  const std::optional<std::uint32_t> address = read_address(wanted);
  std::string known;
  for (const Interface& one : all) {
    if (one.name == wanted || (address && one.address == *address)) return one;
    if (address && one.loopback && same_network(*address, one.address, one.mask)) {
      Interface loopback = one;
      loopback.address = *address;
      return loopback;
    }
    known += (known.empty() ? "" : ", ") + one.name + " (" + address_text(one.address) + ")";
  }
  // Not there yet, for all that is known: a unit that boots gets its address late.
  return fail(Errc::DeviceNotFound, "no interface %s with an IPv4 address; there are %s", wanted.c_str(),
              known.empty() ? "none" : known.c_str());
}

Result<void> keep_off_camera(const Interface& interface, std::uint32_t camera) {
  if (!same_network(interface.address, camera, interface.mask)) return {};
  return fail(Errc::InvalidArgument,
              "%s (%s) reaches the camera at %s: name an interface that is not the camera's",
              interface.name.c_str(), address_text(interface.address).c_str(), address_text(camera).c_str());
}

Result<std::vector<std::uint32_t>> devices_on(const Interface& interface) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds k_patience{500};
  // DISCOVERY, answer wanted.
  constexpr std::array<std::uint8_t, k_command_header_bytes> k_ask{0x42, 0x11, 0, 0x02, 0, 0, 0, 1};
  const int asking = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (asking < 0) return fail_errno(Errc::DeviceError, errno, "socket");
  const int yes = 1;
  setsockopt(asking, SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_addr.s_addr = htonl(interface.address);
  std::vector<std::uint32_t> found;
  int fault = 0;
  if (bind(asking, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0) fault = errno;
  place.sin_addr.s_addr = htonl(interface.broadcast());
  place.sin_port = htons(k_port);
  if (fault == 0 && sendto(asking, k_ask.data(), k_ask.size(), 0, reinterpret_cast<const sockaddr*>(&place),
                           sizeof place) < 0)
    fault = errno;
  const Clock::time_point end = Clock::now() + k_patience;
  while (fault == 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd wait{.fd = asking, .events = POLLIN, .revents = 0};
    if (left <= 0 || poll(&wait, 1, static_cast<int>(left)) <= 0) break;
    std::array<std::uint8_t, 1024> answer{};
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t got = recvfrom(asking, answer.data(), answer.size(), MSG_DONTWAIT,
                                 reinterpret_cast<sockaddr*>(&from), &size);
    const bool whole = got >= static_cast<ssize_t>(k_command_header_bytes + bootstrap::k_discovery_bytes);
    if (whole && half_at(answer, 2) == command::k_discovery + 1) found.push_back(ntohl(from.sin_addr.s_addr));
  }
  close(asking);
  if (fault != 0)
    return fail_errno(Errc::DeviceError, fault, "%s: no question for cameras could be sent",
                      interface.name.c_str());
  return found;
}

}  // namespace biteline::gige
