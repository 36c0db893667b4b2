// SPDX-License-Identifier: MIT
#include "firmware/stream/stream_socket.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/key_set.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::stream {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

/// Far above the second after which a list is looked at, and a loaded machine's pauses.
constexpr seconds k_patience{20};

/// A host's end: says one byte again and again.
struct Caller {
  wire::SocketContext context;
  wire::Socket socket;
  wire::Socket watcher;
  std::uint8_t word;
  bool refused{false};

  static Caller to(const std::string& address, const wire::HostKeys& keys, std::uint8_t word) {
    wire::SocketContext context = *wire::SocketContext::create();
    const wire::Endpoint endpoint = *wire::parse_endpoint(address);
    wire::Socket socket = *wire::open_caller(context, endpoint, keys);
    wire::Socket watcher = *wire::open_watcher(context, socket);
    SUCCEEDS(socket.connect(address));
    return {std::move(context), std::move(socket), std::move(watcher), word};
  }
  void speak() {
    socket.send({{&word, 1}});
    while (const auto event = wire::next_event(watcher))
      refused |= *event == wire::LinkEvent::AuthenticationFailed;
  }
};

}  // namespace

TEST_GROUP(StreamSocket) {
  test::TemporaryFolder folder;
  std::array<int, 3> heard{};

  std::filesystem::path sensor() const {
    return folder.path() / "sensor";
  }
  wire::HostKeys host(const std::string& name) const {
    const auto own = folder.path() / name;
    SUCCEEDS(wire::make_host_keys(own));
    std::filesystem::copy_file(sensor() / "sensor.public", own / "sensor.public");
    return *wire::read_host_keys(own);
  }
  Result<std::unique_ptr<StreamSocket>> open() const {
    StreamSocket::Config config;
    config.keys = *wire::read_sensor_keys(sensor());
    return StreamSocket::open(std::move(config));
  }
  template <class Until>
  bool serve(StreamSocket & sut, std::initializer_list<Caller*> callers, Until && until) {
    heard = {};
    for (const auto end = steady_clock::now() + k_patience; steady_clock::now() < end;) {
      for (Caller* caller : callers) caller->speak();
      static_cast<void>(
          sut.receive(milliseconds{10}, [this](const PeerId&, std::span<const std::uint8_t> packet) {
            if (packet.size() == 1 && packet[0] < heard.size()) ++heard[packet[0]];
          }));
      if (until()) return true;
    }
    return false;
  }
};

TEST(StreamSocket, RevokedHostIsCutOffAndANewOneComesInWhileTheSensorRuns) {
  SUCCEEDS(wire::make_sensor_keys(sensor()));
  const wire::HostKeys first_keys = host("first"), second_keys = host("second"), late_keys = host("late");
  SUCCEEDS(wire::allow_host(sensor(), "first", folder.path() / "first/host.public"));
  SUCCEEDS(wire::allow_host(sensor(), "second", folder.path() / "second/host.public"));
  auto sut = open();
  SUCCEEDS(sut);
  Caller first = Caller::to((*sut)->address(), first_keys, 0),
         second = Caller::to((*sut)->address(), second_keys, 1);
  CHECK(serve(**sut, {&first, &second}, [&] { return heard[0] > 3 && heard[1] > 3; }));

  SUCCEEDS(wire::revoke_host(sensor(), "first"));
  CHECK(serve(**sut, {&first, &second}, [&] { return first.refused; }));
  CHECK(serve(**sut, {&first, &second}, [&] { return heard[1] > 20; }));
  LONGS_EQUAL(0, heard[0]);

  SUCCEEDS(wire::allow_host(sensor(), "late", folder.path() / "late/host.public"));
  // Whoever knocks before the list is read again is refused, and has to knock anew.
  bool came = false;
  for (const auto end = steady_clock::now() + k_patience; !came && steady_clock::now() < end;) {
    Caller late = Caller::to((*sut)->address(), late_keys, 2);
    CHECK(serve(**sut, {&second, &late}, [&] { return late.refused || (heard[1] > 3 && heard[2] > 3); }));
    came = !late.refused;
  }
  CHECK(came);
}

TEST(StreamSocket, BrokenListChangesNothingUntilItIsMended) {
  SUCCEEDS(wire::make_sensor_keys(sensor()));
  const wire::HostKeys first_keys = host("first");
  SUCCEEDS(wire::allow_host(sensor(), "first", folder.path() / "first/host.public"));
  auto sut = open();
  SUCCEEDS(sut);
  Caller first = Caller::to((*sut)->address(), first_keys, 0);
  CHECK(serve(**sut, {&first}, [&] { return heard[0] > 3; }));
  folder.write("sensor/hosts.allowed", "half a line");
  const auto broken = steady_clock::now();
  CHECK(serve(**sut, {&first},
              [&] { return heard[0] > 3 && steady_clock::now() > broken + milliseconds{1500}; }));
  CHECK(!first.refused);
}

}  // namespace biteline::stream
