// SPDX-License-Identifier: MIT
// The wire's two ends with a network between them that loses, doubles, changes and makes up packets: profiles
// come out in order, none twice, and none that was not sent.
#include <deque>

#include "common/wire/messages.hpp"
#include "firmware/stream/stream_server.hpp"
#include "host/intake/host_protocol.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

namespace {

struct Wire final : stream::Outbox {
  std::deque<wire::Bytes> to_host, to_sensor;
  bool send(const stream::PeerId&, std::span<const std::uint8_t> packet) override {
    if (to_host.size() > 100) return false;
    to_host.emplace_back(packet.begin(), packet.end());
    return true;
  }
};

/// The next packet of a queue, after what the network did to it; nothing: it is lost.
std::optional<wire::Bytes> delivered(std::deque<wire::Bytes>& queue, fuzz::Case& bytes) {
  if (queue.empty()) return std::nullopt;
  wire::Bytes packet = queue.front();
  const auto fate = bytes.take<std::uint8_t>();
  if (fate % 8 == 1) return packet;  // and comes again
  queue.pop_front();
  if (fate % 8 == 2) return std::nullopt;
  if (fate % 8 == 3 && !packet.empty())
    packet[bytes.take<std::uint16_t>() % packet.size()] ^= bytes.take<std::uint8_t>();
  if (fate % 8 == 4) packet.resize(packet.size() / 2);
  return packet;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Case bytes{data, size};
  Wire wire;
  stream::StreamServer sensor(
      {.store_bytes = 64 * 1024, .observers = {}}, {}, wire, [](wire::Command) { return Result<void>{}; },
      [] { return wire::Health{}; });
  std::optional<intake::HostProtocol> host;
  const auto renew = [&] {
    host.emplace(intake::HostProtocolConfig{}, [&](std::span<const std::uint8_t> packet) {
      if (wire.to_sensor.size() < 100) wire.to_sensor.emplace_back(packet.begin(), packet.end());
    });
  };
  renew();
  std::uint64_t scan = 1, next = 0;
  std::int64_t now_ns = 1;
  sensor.begin_scan(scan, "scan", 0);
  for (int turn = 0; turn < 400 && !bytes.empty(); ++turn) {
    now_ns += 1'000'000LL * bytes.take<std::uint8_t>();
    const SensorClock::time_point sensor_now{Nanoseconds{now_ns}};
    const HostClock::time_point host_now{Nanoseconds{now_ns}};
    const auto deed = bytes.take<std::uint8_t>();
    if (deed % 4 == 0) {
      profile::ProfileHeader header;
      header.sequence = deed;
      sensor.add_profile(header, std::vector<profile::ProfilePoint>(deed % 7U));
    } else if (deed == 1) {
      sensor.add_end({});
    } else if (deed == 5) {
      sensor.begin_scan(++scan, "next", 0);
    } else if (deed == 9) {
      sensor.on_packet("stranger", bytes.take_bytes(bytes.take<std::uint8_t>()), sensor_now);
    } else if (deed == 13) {
      host->on_connected(host_now);
    } else if (deed == 17) {
      host->command({.id = deed, .command = wire::Command::StartScan});
    }
    host->tick(host_now);
    sensor.tick(sensor_now);
    for (int i = 0; i < 4; ++i) {
      if (const auto packet = delivered(wire.to_sensor, bytes)) sensor.on_packet("host", *packet, sensor_now);
      const auto packet = delivered(wire.to_host, bytes);
      if (!packet) continue;
      const auto event = host->on_packet(*packet, host_now);
      if (!event) {
        fuzz::demand_clean(event.error());
        renew();
        next = 0;
        continue;
      }
      if (!*event) continue;
      if (const auto* hello = std::get_if<intake::Hello>(&**event); hello != nullptr && !hello->resumed)
        next = 0;
      if (const auto* profile = std::get_if<intake::ProfileEvent>(&**event)) {
        fuzz::demand(profile->sequence >= next, "profiles come in order and none twice");
        next = profile->sequence + 1;
      }
    }
  }
  return 0;
}
