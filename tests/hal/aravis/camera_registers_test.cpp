// SPDX-License-Identifier: MIT
/// \file The simulated camera asked by a client that knows no manners: GVCP packets of our own, without
/// Aravis.
#include <CppUTest/TestHarness.h>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "hal/sim/gvcamera/genicam_description.hpp"
#include "hal/sim/gvcamera/gv_camera.hpp"
#include "hal/sim/gvcamera/register_guard.hpp"
#include "tests/support/fuzz.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::sim {

namespace {

constexpr std::uint32_t k_memory = 0x10000;
using Bytes = std::vector<std::uint8_t>;

void put(Bytes& out, std::uint32_t value, int bytes) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
    out.push_back(static_cast<std::uint8_t>(value >> static_cast<unsigned>(shift)));
}
std::uint32_t word_at(const Bytes& from, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8U | from[at + i];
  return value;
}

struct Reply {
  std::uint16_t status{0};
  Bytes data;
};

/// GigE Vision 1.2, chapter 18.
class Client {
 public:
  Client() : socket_{socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)} {
    sockaddr_in camera{};
    camera.sin_family = AF_INET;
    camera.sin_port = htons(3956);
    camera.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    CHECK(connect(socket_, reinterpret_cast<const sockaddr*>(&camera), sizeof camera) == 0);
  }
  ~Client() { close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  Reply read_register(std::uint32_t address) {
    Bytes body;
    put(body, address, 4);
    return ask(0x0080, body);
  }
  Reply read_memory(std::uint32_t address, std::uint16_t bytes) {
    Bytes body;
    put(body, address, 4);
    put(body, bytes, 4);
    return ask(0x0084, body);
  }
  Reply write_memory(std::uint32_t address, std::uint32_t value) {
    Bytes body;
    put(body, address, 4);
    put(body, value, 4);
    return ask(0x0086, body);
  }
  Reply write_register(std::uint32_t address, std::uint32_t value) {
    Bytes body;
    put(body, address, 4);
    put(body, value, 4);
    return ask(0x0082, body);
  }
  /// A packet as it stands, and what comes back for it.
  Bytes exchange(const Bytes& packet) const {
    CHECK(send(socket_, packet.data(), packet.size(), 0) == static_cast<ssize_t>(packet.size()));
    pollfd waiting{.fd = socket_, .events = POLLIN, .revents = 0};
    if (poll(&waiting, 1, 10'000) != 1) FAIL("the camera answers no more");
    Bytes in(70'000);
    const ssize_t got = recv(socket_, in.data(), in.size(), 0);
    CHECK(got >= 0);
    in.resize(static_cast<std::size_t>(got));
    return in;
  }
  std::uint32_t value(std::uint32_t address) {
    const Reply reply = read_register(address);
    LONGS_EQUAL(0, reply.status);
    return reply.data.size() == 4 ? word_at(reply.data, 0) : 0;
  }

 private:
  Reply ask(std::uint16_t command, const Bytes& body) {
    ++number_;
    Bytes packet{0x42, 0x01};
    put(packet, command, 2);
    put(packet, static_cast<std::uint32_t>(body.size()), 2);
    put(packet, number_, 2);
    packet.insert(packet.end(), body.begin(), body.end());
    CHECK(send(socket_, packet.data(), packet.size(), 0) == static_cast<ssize_t>(packet.size()));
    while (true) {
      pollfd waiting{.fd = socket_, .events = POLLIN, .revents = 0};
      if (poll(&waiting, 1, 10'000) != 1) FAIL("the camera answers no more");
      Bytes in(70'000);
      const ssize_t got = recv(socket_, in.data(), in.size(), 0);
      CHECK(got >= 8);
      in.resize(static_cast<std::size_t>(got));
      if ((in[6] << 8U | in[7]) != number_) continue;
      Reply reply{.status = static_cast<std::uint16_t>(in[0] << 8U | in[1]),
                  .data = {in.begin() + 8, in.end()}};
      LONGS_EQUAL(command + 1, in[2] << 8U | in[3]);
      LONGS_EQUAL(reply.data.size(), in[4] << 8U | in[5]);
      return reply;
    }
  }

  int socket_;
  std::uint16_t number_{0};
};

std::unique_ptr<GvCamera> open_camera() {
  GvCamera::Config config;
  config.region = {.offset_u_px = 0, .offset_v_px = 456, .width_px = 640, .height_px = 120};
  for (int attempt = 0; attempt < 100; ++attempt) {
    if (auto camera = GvCamera::open(config, [](const GvExposure&, std::span<std::uint8_t>) {})) {
      test::note_ran();
      return std::move(*camera);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
  }
  test::note_skipped("GigE Vision port 3956 on 127.0.0.1 is not free");
  return nullptr;
}

int status(gige::Status status) {
  return static_cast<int>(status);
}

}  // namespace

TEST_GROUP(CameraRegisters) {
  std::unique_ptr<GvCamera> camera = open_camera();
};

// Aravis 0.8.26 copies past its memory for one such read.
TEST(CameraRegisters, AnyReadIsAnsweredOrRefusedAndHarmsNothing) {
  if (!camera) return;
  Client client;
  const auto description = static_cast<std::uint32_t>(genicam_description().size());
  const std::uint32_t end = k_memory + (description + 3) / 4 * 4;
  std::vector<std::uint32_t> addresses{0xffff'ff00, 0xffff'fffc, 0xffff'ffff, k_memory - 4, k_memory - 2,
                                       k_memory,    end - 4,     end,         end - 1,      end + 4};
  for (unsigned bit = 0; bit < 32; ++bit) {
    for (const std::uint32_t beside : {0U, 4U, 1U}) {
      addresses.push_back((1U << bit) + beside);
      addresses.push_back((1U << bit) - beside);
    }
  }
  std::mt19937 random{5};
  for (int i = 0; i < 300 * test::fuzz_factor(); ++i) addresses.push_back(random() >> (random() % 32));
  for (const std::uint32_t address : addresses) {
    const gige::Status one = may_read({address, 4}, description);
    const Reply word = client.read_register(address);
    LONGS_EQUAL(status(one), word.status);
    LONGS_EQUAL(one == gige::Status::Success ? 4 : 0, word.data.size());
    for (const unsigned bytes : {0U, 4U, 512U, 65'000U, static_cast<unsigned>(random() % 2000)}) {
      const gige::Status many = may_read({address, bytes}, description);
      const Reply block = client.read_memory(address, static_cast<std::uint16_t>(bytes));
      LONGS_EQUAL(status(many), block.status);
    }
  }
  // And it still is the camera that it was.
  LONGS_EQUAL(640, client.value(gv_register::k_width));
}

/// GigE Vision 1.2, chapters 17 to 19, byte by byte: key, flags, command, length, number; then the answer's.
TEST(CameraRegisters, GoldenBytesOfTheControlProtocol) {
  if (!camera) return;
  Client client;
  // READREG of the control channel's privilege: nobody has it.
  CHECK((Bytes{0, 0, 0, 0x81, 0, 4, 0, 7, 0, 0, 0, 0}) ==
        client.exchange({0x42, 0x01, 0, 0x80, 0, 4, 0, 7, 0, 0, 0x0a, 0}));
  // WRITEREG takes control; the answer counts the registers written.
  CHECK((Bytes{0, 0, 0, 0x83, 0, 4, 0, 8, 0, 0, 0, 1}) ==
        client.exchange({0x42, 0x01, 0, 0x82, 0, 8, 0, 8, 0, 0, 0x0a, 0, 0, 0, 0, 2}));
  CHECK((Bytes{0, 0, 0, 0x81, 0, 4, 0, 9, 0, 0, 0, 2}) ==
        client.exchange({0x42, 0x01, 0, 0x80, 0, 4, 0, 9, 0, 0, 0x0a, 0}));
  // READMEM: the answer begins with the address; device mode and MAC stand before it in the bootstrap block.
  const Bytes memory = client.exchange({0x42, 0x01, 0, 0x84, 0, 8, 0, 10, 0, 0, 0, 0x48, 0, 0, 0, 4});
  CHECK((Bytes{0, 0, 0, 0x85, 0, 8, 0, 10, 0, 0, 0, 0x48}) == Bytes(memory.begin(), memory.begin() + 12));
  LONGS_EQUAL(16, memory.size());
  // DISCOVERY: 248 bytes.
  const Bytes found = client.exchange({0x42, 0x11, 0, 0x02, 0, 0, 0, 11});
  CHECK((Bytes{0, 0, 0, 0x03, 0, 0xf8, 0, 11}) == Bytes(found.begin(), found.begin() + 8));
  LONGS_EQUAL(8 + 248, found.size());
  // The address that it answers at, 127.0.0.1, where the standard has it.
  CHECK((Bytes{127, 0, 0, 1}) == Bytes(found.begin() + 8 + 36, found.begin() + 8 + 40));
}

constexpr std::uint32_t k_privilege = 0xa00, k_heartbeat = 0x938;

TEST(CameraRegisters, SecondApplicationReadsAndIsDeniedEveryWrite) {
  if (!camera) return;
  Client first, second;
  LONGS_EQUAL(status(gige::Status::AccessDenied),
              first.write_register(gv_register::k_exposure_us, 500).status);
  LONGS_EQUAL(0, first.write_register(k_privilege, 2).status);
  // Control, a register, memory: status 0x8006, the answer's kind, no data, the number.
  CHECK((Bytes{0x80, 0x06, 0, 0x83, 0, 0, 0, 8}) ==
        second.exchange({0x42, 0x01, 0, 0x82, 0, 8, 0, 8, 0, 0, 0x0a, 0, 0, 0, 0, 2}));
  CHECK((Bytes{0x80, 0x06, 0, 0x83, 0, 0, 0, 9}) ==
        second.exchange({0x42, 0x01, 0, 0x82, 0, 8, 0, 9, 0, 0, 0x01, 0x20, 0, 0, 1, 0xf4}));
  CHECK((Bytes{0x80, 0x06, 0, 0x87, 0, 0, 0, 10}) ==
        second.exchange({0x42, 0x01, 0, 0x86, 0, 8, 0, 10, 0, 0, 0x01, 0x20, 0, 0, 1, 0xf4}));
  CHECK((Bytes{0, 0, 0, 0x81, 0, 4, 0, 11, 0, 0, 0, 2}) ==
        second.exchange({0x42, 0x01, 0, 0x80, 0, 4, 0, 11, 0, 0, 0x0a, 0}));
  LONGS_EQUAL(400, second.value(gv_register::k_exposure_us));
  LONGS_EQUAL(0, first.write_memory(gv_register::k_exposure_us, 500).status);
  LONGS_EQUAL(500, second.value(gv_register::k_exposure_us));
  // Given back, it is the other's to take.
  LONGS_EQUAL(0, first.write_register(k_privilege, 0).status);
  LONGS_EQUAL(0, second.write_register(k_privilege, 1).status);
  LONGS_EQUAL(status(gige::Status::AccessDenied), first.write_register(k_privilege, 2).status);
  LONGS_EQUAL(1, first.value(k_privilege));
}

TEST(CameraRegisters, MissedHeartbeatEndsControlAndStream) {
  if (!camera) return;
  Client dead, next;
  LONGS_EQUAL(0, dead.write_register(k_privilege, 2).status);
  LONGS_EQUAL(0, dead.write_register(k_heartbeat, 500).status);
  LONGS_EQUAL(0, dead.write_register(0xd18, INADDR_LOOPBACK).status);
  LONGS_EQUAL(0, dead.write_register(gv_register::k_stream_port, 9).status);
  LONGS_EQUAL(0, dead.write_register(gv_register::k_acquisition, 1).status);
  // Somebody else's looks at the privilege are no heartbeat.
  int looks = 0;
  while (next.write_register(k_privilege, 2).status != 0) {
    LONGS_EQUAL(2, next.value(k_privilege));
    CHECK(++looks < 200);
    std::this_thread::sleep_for(std::chrono::milliseconds{50});
  }
  LONGS_EQUAL(0, next.value(gv_register::k_acquisition));
  LONGS_EQUAL(0, next.value(gv_register::k_stream_port));
  LONGS_EQUAL(status(gige::Status::AccessDenied), dead.write_register(gv_register::k_acquisition, 1).status);
}

TEST(CameraRegisters, HeartbeatOfItsOwnKeepsControl) {
  if (!camera) return;
  Client first, second;
  LONGS_EQUAL(0, first.write_register(k_privilege, 2).status);
  LONGS_EQUAL(0, first.write_register(k_heartbeat, 2000).status);
  for (int i = 0; i < 30; ++i) {
    LONGS_EQUAL(2, first.value(k_privilege));
    LONGS_EQUAL(status(gige::Status::AccessDenied), second.write_register(k_privilege, 2).status);
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
  }
}

TEST(CameraRegisters, EveryWordOfItsSpaceCanBeRead) {
  if (!camera) return;
  Client client;
  const std::string description = genicam_description();
  const auto end = static_cast<std::uint32_t>(k_memory + (description.size() + 3) / 4 * 4);
  Bytes all;
  for (std::uint32_t at = 0; at < end; at += 512) {
    const Reply block = client.read_memory(at, static_cast<std::uint16_t>(std::min(512U, end - at)));
    LONGS_EQUAL(0, block.status);
    CHECK(block.data.size() > 4 && word_at(block.data, 0) == at);
    all.insert(all.end(), block.data.begin() + 4, block.data.end());
  }
  const std::string told(all.begin() + k_memory,
                         all.begin() + k_memory + static_cast<long>(description.size()));
  CHECK(told == description);
  STRCMP_EQUAL("Biteline", reinterpret_cast<const char*>(&all[gv_register::k_vendor_name]));
  STRCMP_EQUAL("SimulatedLineCamera", reinterpret_cast<const char*>(&all[gv_register::k_model_name]));
}

TEST(CameraRegisters, ValuesOutOfRangeAreRefusedAndChangeNothing) {
  if (!camera) return;
  Client client;
  LONGS_EQUAL(0, client.write_register(0xa00, 2).status);  // control
  using namespace gv_register;
  struct Row {
    std::uint32_t address, value;
    gige::Status status;
  };
  // The region is 640 x 120 at (0, 456) of 1626 x 1236 pixels.
  const Row rows[] = {
      {k_exposure_us, 5, gige::Status::InvalidParameter},
      {k_exposure_us, 2'000'000, gige::Status::InvalidParameter},
      {k_exposure_us, 500, gige::Status::Success},
      {k_width, 8, gige::Status::InvalidParameter},
      {k_width, 100'000, gige::Status::InvalidParameter},
      {k_width, 1626, gige::Status::Success},
      {k_offset_x, 1, gige::Status::InvalidParameter},
      {k_height, 0, gige::Status::InvalidParameter},
      {k_height, 781, gige::Status::InvalidParameter},
      {k_height, 780, gige::Status::Success},
      {k_offset_y, 457, gige::Status::InvalidParameter},
      {k_offset_y, 0, gige::Status::Success},
      {k_acquisition_mode, 3, gige::Status::InvalidParameter},
      {k_sequencer_start, 255, gige::Status::InvalidParameter},
      {k_sensor_width, 4000, gige::Status::WriteProtected},
      {0x200, 0, gige::Status::WriteProtected},  // the description's address
      {0xd04, 0, gige::Status::InvalidParameter},
      {0xd04, 0x8000'0000 + 1400, gige::Status::Success},  // a test packet is asked for
      {0x122, 1, gige::Status::BadAlignment},
      {k_memory, 1, gige::Status::InvalidAddress},
      {0xffff'fffc, 1, gige::Status::InvalidAddress},
  };
  for (const Row& row : rows) {
    const Reply before = client.read_register(row.address);
    LONGS_EQUAL(status(row.status), client.write_register(row.address, row.value).status);
    const Reply after = client.read_register(row.address);
    if (row.status != gige::Status::Success) {
      CHECK(before.data == after.data);
    } else if (row.address != 0xd04) {
      LONGS_EQUAL(row.value, word_at(after.data, 0));
    }
  }
  LONGS_EQUAL(1400, client.value(0xd04));
}

TEST(CameraRegisters, ASingleFrameStreamEndsByItself) {
  if (!camera) return;
  Client client;
  LONGS_EQUAL(0, client.write_register(0xa00, 2).status);
  using namespace gv_register;
  LONGS_EQUAL(0, client.write_register(k_acquisition_mode, k_single_frame).status);
  LONGS_EQUAL(0, client.write_register(0xd18, INADDR_LOOPBACK).status);
  LONGS_EQUAL(0, client.write_register(k_stream_port, 9).status);
  for (std::uint64_t frames = 1; frames <= 3; ++frames) {
    LONGS_EQUAL(0, client.write_register(k_acquisition, 1).status);
    for (int i = 0; i < 1000 && client.value(k_acquisition) != 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds{10});
    LONGS_EQUAL(0, client.value(k_acquisition));
    std::this_thread::sleep_for(std::chrono::milliseconds{200});  // four frames' time at 20 Hz
    LONGS_EQUAL(frames, camera->exposures());
  }
}

TEST(CameraRegisters, TheSequencersStartReadsAsItWasWritten) {
  if (!camera) return;
  Client client;
  LONGS_EQUAL(0, client.value(gv_register::k_sequencer_start));
  LONGS_EQUAL(0, client.write_register(0xa00, 2).status);
  for (const std::uint32_t set : {1U, 0U}) {
    LONGS_EQUAL(0, client.write_register(gv_register::k_sequencer_start, set).status);
    LONGS_EQUAL(set, client.value(gv_register::k_sequencer_start));
  }
}

}  // namespace biteline::sim
