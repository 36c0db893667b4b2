// SPDX-License-Identifier: MIT
// The sensor's and the host's ends of the protocol against each other, over a network that loses, doubles,
// swaps and garbles packets and breaks connections.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "firmware/stream/stream_server.hpp"
#include "host/intake/host_protocol.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_profile.hpp"

namespace biteline::intake {
namespace {

struct Trouble {
  double lose{0}, twice{0}, swap{0}, garble{0}, disconnect{0};
};

/// One direction.
class Wire {
 public:
  void put(std::span<const std::uint8_t> packet) { packets_.emplace_back(packet.begin(), packet.end()); }
  void cut() { packets_.clear(); }

  std::vector<wire::Bytes> deliver(std::mt19937& random, const Trouble& trouble) {
    std::uniform_real_distribution<double> chance{0, 1};
    std::vector<wire::Bytes> arrived;
    for (wire::Bytes& packet : packets_) {
      if (chance(random) < trouble.lose) continue;
      if (chance(random) < trouble.garble) packet[random() % packet.size()] ^= 0x55;
      if (chance(random) < trouble.twice) arrived.push_back(packet);
      arrived.push_back(std::move(packet));
      if (arrived.size() > 1 && chance(random) < trouble.swap)
        std::swap(arrived.back(), arrived[arrived.size() - 2]);
    }
    packets_.clear();
    return arrived;
  }

 private:
  std::deque<wire::Bytes> packets_;
};

class Network final : public stream::Outbox {
 public:
  bool send(const stream::PeerId& peer, std::span<const std::uint8_t> packet) override {
    if (peer != address) return false;  // an address of before the connection broke
    to_host.put(packet);
    return true;
  }
  Wire to_host, to_sensor;
  stream::PeerId address{"0"};
};

}  // namespace

TEST_GROUP(BothEnds) {
  std::mt19937 random{11};
  Network network;
  std::int64_t now_ns{1'000'000'000'000};
  stream::ServerConfig server_config;
  std::unique_ptr<stream::StreamServer> server;
  std::unique_ptr<HostProtocol> host;
  std::vector<std::uint64_t> received;
  std::uint64_t lost{0};
  bool ended{false};
  std::uint64_t produced{0};
  static constexpr std::uint64_t k_profiles = 300;

  void setup() override {
    server_config.store_bytes = 4 * 1024 * 1024;
    // A connection that breaks comes back from another address, and the old one counts as present for 2 s.
    server_config.max_hosts = 64;
    start_server();
    start_host({});
  }
  void start_server() {
    wire::SensorHello identity;
    identity.model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 1, .height_px = 1};
    server = std::make_unique<stream::StreamServer>(
        server_config, identity, network, [](wire::Command) -> Result<void> { return {}; },
        [] { return wire::Health{}; });
    server->begin_scan(42, "made", k_profiles);
  }
  void start_host(HostProtocolConfig config) {
    host = std::make_unique<HostProtocol>(
        std::move(config), [this](std::span<const std::uint8_t> packet) { network.to_sensor.put(packet); });
  }
  SensorClock::time_point sensor_now() const {
    return SensorClock::time_point{Nanoseconds{now_ns}};
  }
  HostClock::time_point host_now() const {
    return HostClock::time_point{Nanoseconds{now_ns}};
  }

  void produce(bool lossless) {
    for (int i = 0; i < 3 && produced < k_profiles; ++i) {
      if (lossless && !server->has_room()) return;
      const profile::Profile profile = test::made_profile(produced++, 20);
      server->add_profile(profile.header, profile.points);
      if (produced == k_profiles) server->add_end({});
    }
  }
  void take(const LinkEvent& event) {
    if (const auto* profile = std::get_if<ProfileEvent>(&event))
      received.push_back(profile->profile.header.sequence);
    if (const auto* loss = std::get_if<LossEvent>(&event)) lost += loss->messages;
    if (std::holds_alternative<wire::EndOfScan>(event)) ended = true;
  }
  /// 10 ms of both sides' lives.
  void turn(const Trouble& trouble, bool lossless = true) {
    std::uniform_real_distribution<double> chance{0, 1};
    now_ns += 10'000'000;
    produce(lossless);
    if (chance(random) < trouble.disconnect) {
      network.to_host.cut();
      network.to_sensor.cut();
      network.address += "'";
    }
    host->tick(host_now());
    for (const wire::Bytes& packet : network.to_sensor.deliver(random, trouble))
      server->on_packet(network.address, packet, sensor_now());
    server->tick(sensor_now());
    for (const wire::Bytes& packet : network.to_host.deliver(random, trouble)) {
      const auto event = host->on_packet(packet, host_now());
      SUCCEEDS(event);
      if (*event) take(**event);
    }
  }
  void run(const Trouble& trouble, bool lossless = true) {
    // A minute of simulated time for 3 s of scan.
    for (int turns = 0; turns < 6000 && !ended; ++turns) turn(trouble, lossless);
    CHECK_TEXT(ended, "the scan's end never arrived");
  }
  void everything_arrived_once() {
    LONGS_EQUAL(k_profiles, received.size());
    for (std::uint64_t i = 0; i < k_profiles; ++i) LONGS_EQUAL(i, received[i]);
    LONGS_EQUAL(0, lost);
  }
};

TEST(BothEnds, QuietNetworkNeedsNoRepetition) {
  run({});
  everything_arrived_once();
  LONGS_EQUAL(0, host->counters().duplicates);
  LONGS_EQUAL(0, host->counters().rewinds);
}

TEST(BothEnds, EverythingArrivesOnceAndInOrderOverABadNetwork) {
  const Trouble rows[] = {
      {.lose = 0.1},        {.twice = 0.2},
      {.swap = 0.2},        {.garble = 0.03},
      {.disconnect = 0.05}, {.lose = 0.05, .twice = 0.05, .swap = 0.05, .garble = 0.01, .disconnect = 0.02},
  };
  for (const Trouble& trouble : rows) {
    received.clear();
    ended = false;
    produced = 0;
    network.to_host.cut();
    network.to_sensor.cut();
    start_server();
    start_host({});
    run(trouble);
    everything_arrived_once();
  }
}

TEST(BothEnds, HostThatDiesAndComesBackLosesNothing) {
  for (int i = 0; i < 50; ++i) turn({});
  const std::size_t before = received.size();
  CHECK(before > 20 && before < k_profiles);
  // Dead for five seconds; its successor knows nothing and gets all of it again.
  host.reset();
  network.address = "next";
  for (int i = 0; i < 500; ++i) {
    now_ns += 10'000'000;
    produce(true);
    network.to_sensor.cut();
    server->tick(sensor_now());
    network.to_host.cut();
  }
  received.clear();
  start_host({});
  run({});
  everything_arrived_once();
}

TEST(BothEnds, HostThatKeptItsPlaceGoesOnThere) {
  for (int i = 0; i < 50; ++i) turn({});
  const ScanPosition position = host->position();
  network.address = "next";
  network.to_host.cut();
  network.to_sensor.cut();
  start_host({.name = "h", .resume = position});
  run({});
  everything_arrived_once();
}

TEST(BothEnds, LiveSensorWithASmallStoreCountsExactlyWhatIsGone) {
  server_config.store_bytes = 60'000;  // some 40 of these profiles
  start_server();
  for (int i = 0; i < 10; ++i) turn({}, false);
  // The host is away while most of the scan passes.
  for (int i = 0; i < 60; ++i) {
    now_ns += 10'000'000;
    produce(false);
    server->tick(sensor_now());
    network.to_host.cut();
    network.to_sensor.cut();
  }
  run({}, false);
  CHECK(lost > 50);
  LONGS_EQUAL(k_profiles, received.size() + lost);
  LONGS_EQUAL(lost, host->counters().lost);
  CHECK(std::is_sorted(received.begin(), received.end()));
  CHECK(std::adjacent_find(received.begin(), received.end()) == received.end());
}

}  // namespace biteline::intake
