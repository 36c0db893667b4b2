// SPDX-License-Identifier: MIT
#pragma once
/// \file A stream server with peers that keep what they were sent, and a scan that begins.

#include <CppUTest/TestHarness.h>

#include <map>
#include <memory>
#include <vector>

#include "firmware/stream/stream_server.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_profile.hpp"

namespace biteline::stream {

/// Keeps what was sent; a peer may be full.
class FakeOutbox final : public Outbox {
 public:
  bool send(const PeerId& peer, std::span<const std::uint8_t> packet) override {
    if (full) return false;
    Result<wire::Message> message = wire::decode(packet);
    SUCCEEDS(message);
    sent[peer].push_back(std::move(*message));
    return true;
  }

  template <class Kind>
  std::vector<Kind> of(const PeerId& peer) {
    std::vector<Kind> found;
    for (const wire::Message& message : sent[peer]) {
      if (const Kind* kind = std::get_if<Kind>(&message.body)) found.push_back(*kind);
    }
    return found;
  }

  bool full{false};
  std::map<PeerId, std::vector<wire::Message>> sent;
};

inline constexpr std::uint64_t k_scan_id = 99;

struct ServerBench : Utest {
  FakeOutbox outbox;
  SensorClock::time_point now{Nanoseconds{1'000'000'000}};
  std::vector<wire::Command> commands;
  bool door_open{true};
  ServerConfig config{.store_bytes = 1024 * 1024, .window_messages = 4, .max_hosts = 2, .observers = {}};
  std::unique_ptr<StreamServer> sut;

  void setup() override { make(); }

  void make() {
    sut = std::make_unique<StreamServer>(
        config, wire::SensorHello{.name = "s", .version = {}, .scan_name = {}, .model = model()}, outbox,
        [this](wire::Command command) -> Result<void> {
          commands.push_back(command);
          if (command == wire::Command::StartScan && door_open) return fail(Errc::InterlockOpen, "door");
          return {};
        },
        [] { return wire::Health{}; });
    sut->begin_scan(k_scan_id, "scan", 0);
  }

  static geometry::SensorModel model() {
    geometry::SensorModel sensor;
    sensor.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 10, .height_px = 10};
    return sensor;
  }

  void receive(const PeerId& peer, wire::Body body) {
    wire::Bytes packet;
    wire::encode({.scan_id = k_scan_id, .body = std::move(body)}, packet);
    sut->on_packet(peer, packet, now);
  }
  void add(int profiles, std::size_t points = 3) {
    for (int i = 0; i < profiles; ++i) {
      const profile::Profile profile = test::made_profile(static_cast<std::uint64_t>(i), points);
      sut->add_profile(profile.header, profile.points);
    }
  }
  std::size_t profiles_sent(const PeerId& peer) { return outbox.of<profile::Profile>(peer).size(); }
  wire::Counters counters() {
    wire::Counters result;
    sut->fill(result);
    return result;
  }
};

}  // namespace biteline::stream
