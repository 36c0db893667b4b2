// SPDX-License-Identifier: MIT
// The GigE Vision face: any commands in any order from two clients, with profiles between them.  Nothing is
// sent to a third address, and no answer is longer than the standard allows.
#include "common/gige/bootstrap.hpp"
#include "host/interfaces/gige/device.hpp"
#include "tests/fuzz/case.hpp"
#include "tests/support/made_profile.hpp"

using namespace biteline;

namespace {

constexpr std::size_t k_columns = 40;
/// READMEM's answer: header, address, bytes.
constexpr std::size_t k_most_answer_bytes = gige::k_command_header_bytes + 4 + gige::k_most_memory_bytes;
constexpr int k_most_steps = 60;

/// A command whose frame is sound, so that the case is spent on what it says.
std::vector<std::uint8_t> command(std::uint16_t code, std::span<const std::uint8_t> body) {
  std::vector<std::uint8_t> packet(gige::k_command_header_bytes + body.size());
  packet[0] = 0x42;
  packet[1] = 1;
  gige::put_half(packet, 2, code);
  gige::put_half(packet, 4, static_cast<std::uint16_t>(body.size()));
  gige::put_half(packet, 6, 1);
  std::ranges::copy(body, packet.begin() + gige::k_command_header_bytes);
  return packet;
}

/// Addresses that mean something; a noise of 32 bits hits none of them.
constexpr std::uint32_t k_addresses[] = {gige::bootstrap::k_privilege,
                                         gige::bootstrap::k_heartbeat_timeout,
                                         gige::bootstrap::k_stream_port,
                                         gige::bootstrap::k_stream_packet_size,
                                         gige::bootstrap::k_stream_address,
                                         gige::bootstrap::k_stream_delay,
                                         gige::bootstrap::k_own,
                                         gige::bootstrap::k_own + 4,
                                         gige::bootstrap::k_own + 8,
                                         gige::bootstrap::k_own + 12,
                                         gige::bootstrap::k_own + 16,
                                         gige::bootstrap::k_own + 20,
                                         std::uint32_t{gige::bootstrap::k_discovery_bytes},
                                         gige::bootstrap::k_first_url};

std::vector<std::uint8_t> write_register(fuzz::Case& input) {
  std::vector<std::uint8_t> body(8);
  gige::put_word(body, 0, k_addresses[input.take<std::uint8_t>() % std::size(k_addresses)]);
  gige::put_word(body, 4, input.take<std::uint32_t>());
  return command(gige::command::k_write_register, body);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Case input{data, size};
  const gige::Peer clients[] = {{.address = 0x0100'007f, .port = 5000},
                                {.address = 0x0200'007f, .port = 5001}};
  gige::Device::Clock::time_point now{std::chrono::hours{1}};
  gige::Device device{
      {.address = 0x7f00'0001, .mask = 0xff00'0000, .version = "1", .serial = "7", .name = {}},
      4000,
      [&](const gige::Peer& to, std::span<const std::uint8_t> packet) {
        fuzz::demand(to.address == clients[0].address || to.address == clients[1].address,
                     "the stream goes to a client's own address");
        fuzz::demand(packet.size() <= 16384, "a packet fits an interface");
      }};
  device.set_head(k_columns, {});
  const profile::Profile profile = test::made_profile(1, 12);
  for (int step = 0; step < k_most_steps && !input.empty(); ++step) {
    const auto what = input.take<std::uint8_t>();
    const gige::Peer& from = clients[what >> 7U];
    std::vector<std::uint8_t> packet;
    switch (what % 8) {
      case 0:
        packet = input.take_bytes(input.take<std::uint8_t>());
        break;
      case 1:
      case 2:
        packet = write_register(input);
        break;
      case 3:
        packet = command(input.take<std::uint8_t>(), input.take_bytes(input.take<std::uint8_t>()));
        break;
      case 4:
        device.offer(input.take<std::uint8_t>() % 3, profile);
        continue;
      case 5:
        device.end_scan();
        continue;
      case 6:
        now += std::chrono::milliseconds{input.take<std::uint16_t>()};
        device.tick(now);
        continue;
      default:
        device.set_head(input.take<std::uint8_t>(), {});
        continue;
    }
    const auto answer = device.on_packet(from, packet, now);
    fuzz::demand(!answer || answer->size() <= k_most_answer_bytes, "an answer has its bounds");
  }
  return 0;
}
