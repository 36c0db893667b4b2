// SPDX-License-Identifier: MIT
// A network that takes next to nothing, in a network namespace of this program's own.
#include <CppUTest/TestHarness.h>
#include <arpa/inet.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cfenv>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "common/gige/bootstrap.hpp"
#include "host/interfaces/gige/server.hpp"
#include "tests/gige/aravis_client.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_profile.hpp"

namespace biteline {

using namespace std::chrono_literals;

TEST_GROUP(GigeSlowNetwork) {
  static constexpr std::size_t k_columns = 1000, k_points = 480;
  static constexpr int k_lines = 1000;  // 12 MB, beyond what the socket buffers

  /// All packets of the stream's first frame, from the client's own address.
  static void ask_for_all() {
    const int asking = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    std::array<std::uint8_t, gige::k_command_header_bytes + 12> command{0x42, 0};
    gige::put_half(command, 2, gige::command::k_packet_resend);
    gige::put_half(command, 4, 12);
    gige::put_half(command, 6, 1);
    gige::put_half(command, 10, 1);          // the frame
    gige::put_word(command, 12, 0);          // from its leader
    gige::put_word(command, 16, 0xff'ffff);  // to its end
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    place.sin_port = htons(gige::k_port);
    const ssize_t sent = sendto(asking, command.data(), command.size(), 0,
                                reinterpret_cast<const sockaddr*>(&place), sizeof place);
    STRCMP_EQUAL("", sent > 0 ? "" : std::strerror(errno));
    close(asking);
  }
};

TEST(GigeSlowNetwork, WhatIsAskedForAgainWaitsForNothing) {
  if (unshare(CLONE_NEWNET) != 0 || std::system("ip link set lo up") != 0) {
    UT_PRINT("skipped: no network namespace here");
    return;
  }
  const auto all = gige::interfaces();
  SUCCEEDS(all);
  const auto loopback = gige::choose_interface(*all, "127.0.0.1");
  SUCCEEDS(loopback);
  auto server = gige::Server::open(
      {.interface = *loopback, .clients = {}, .version = "1", .serial = "12", .name = "face"});
  SUCCEEDS(server);
  (*server)->set_head(k_columns, {});
  auto client = test::AravisClient::open("127.0.0.1");
  SUCCEEDS(client);
  SUCCEEDS((*client)->set("Height", k_lines));
  SUCCEEDS((*client)->start(2));
  std::feclearexcept(FE_INVALID | FE_DIVBYZERO);  // raised when Aravis makes its first stream
  for (int line = 0; line < k_lines; ++line) (*server)->offer(1, test::made_profile(line, k_points));
  const auto arrived = (*client)->next_frame(20s);
  CHECK(arrived && arrived->complete);
  LONGS_EQUAL(0, (*server)->counts().unsent_again);

  // A packet each second or so; whoever waits for it waits for half an hour.
  if (std::system("tc qdisc add dev lo root tbf rate 8kbit burst 3000 limit 100mb 2>/dev/null") != 0) {
    UT_PRINT("skipped: this kernel cannot slow a network down");
    return;
  }
  ask_for_all();
  for (int turn = 0; turn < 1000 && (*server)->counts().unsent_again == 0; ++turn)
    std::this_thread::sleep_for(20ms);
  const gige::ServerCounts counts = (*server)->counts();
  CHECK(counts.unsent_again > 0);
  CHECK(counts.unsent_again < counts.stream.resent);
  LONGS_EQUAL(0, counts.unsent);
  LONGS_EQUAL(0, std::system("tc qdisc del dev lo root"));
  SUCCEEDS((*client)->stop());
}

}  // namespace biteline
