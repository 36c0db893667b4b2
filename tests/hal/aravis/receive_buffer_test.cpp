// SPDX-License-Identifier: MIT
#include "hal/linux/aravis/receive_buffer.hpp"

#include <CppUTest/TestHarness.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <string>

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {
namespace {

Descriptor bound_socket(int type) {
  Descriptor socket{::socket(AF_INET, type | SOCK_CLOEXEC, 0)};
  sockaddr_in local{};
  local.sin_family = AF_INET;
  local.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  CHECK(bind(socket.number(), reinterpret_cast<const sockaddr*>(&local), sizeof local) == 0);
  return socket;
}

std::uint16_t port_of(const Descriptor& socket) {
  sockaddr_in local{};
  socklen_t size = sizeof local;
  CHECK(getsockname(socket.number(), reinterpret_cast<sockaddr*>(&local), &size) == 0);
  return ntohs(local.sin_port);
}

int room_bytes(const Descriptor& socket) {
  int bytes = 0;
  socklen_t size = sizeof bytes;
  CHECK(getsockopt(socket.number(), SOL_SOCKET, SO_RCVBUF, &bytes, &size) == 0);
  return bytes;
}

}  // namespace

TEST_GROUP(ReceiveBuffer){};

TEST(ReceiveBuffer, TheSocketAtThePortAloneGetsTheRoomAndTellsIt) {
  const Descriptor wanted = bound_socket(SOCK_DGRAM), other = bound_socket(SOCK_DGRAM);
  const int before_bytes = room_bytes(other);
  // What any program may ask for on any machine: less than net.core.rmem_max.
  constexpr int k_bytes = 60'000;
  const Result<int> room = enlarge_receive_buffer(port_of(wanted), k_bytes);
  CHECK(room.has_value());
  LONGS_EQUAL(2 * k_bytes, *room);  // the kernel keeps as much again for its own book-keeping: socket(7)
  LONGS_EQUAL(2 * k_bytes, room_bytes(wanted));
  LONGS_EQUAL(before_bytes, room_bytes(other));
}

TEST(ReceiveBuffer, APortThatNoUdpSocketOfThisProgramHasIsAnErrorThatNamesIt) {
  const Descriptor tcp = bound_socket(SOCK_STREAM);
  const Result<int> room = enlarge_receive_buffer(port_of(tcp), 60'000);
  CHECK(!room.has_value());
  CHECK(room.error().code == Errc::DeviceError);
  STRCMP_CONTAINS(std::to_string(port_of(tcp)).c_str(), std::string{room.error().where.view()}.c_str());
}

}  // namespace biteline::hal
