// SPDX-License-Identifier: MIT
#include "host/intake/sensor_link.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/wire/socket.hpp"

namespace biteline::intake {
namespace {

/// Between two looks at what is due (acknowledgements).
constexpr Nanoseconds k_turn = std::chrono::milliseconds{10};

HostClock::time_point now() {
  return HostClock::time_point{
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())};
}

}  // namespace

struct SensorLink::State {
  State(SensorLinkConfig settings, wire::SocketContext zmq, wire::Socket socket, wire::Socket events)
      : config{std::move(settings)},
        context{std::move(zmq)},
        caller{std::move(socket)},
        watcher{std::move(events)},
        protocol{config.protocol, [this](std::span<const std::uint8_t> packet) {
                   // What is meant for a connection that is gone must not pile up for the next one.
                   if (connected) caller.send({packet});
                 }} {}

  SensorLinkConfig config;
  wire::SocketContext context;
  wire::Socket caller;
  wire::Socket watcher;
  HostProtocol protocol;
  wire::HandshakeRecord handshakes;
  HostClock::time_point opened{now()};
  bool connected{false};
  int connections{0};
  wire::Bytes last_packet;

  /// An Error: the connection will never come about.
  Result<void> follow_connection() {
    while (const std::optional<wire::LinkEvent> event = wire::next_event(watcher)) {
      const std::string address = config.sensor.text();
      switch (*event) {
        case wire::LinkEvent::Connected:
          handshakes.on_success();
          ++connections;
          connected = true;
          protocol.on_connected(now());
          break;
        case wire::LinkEvent::AuthenticationFailed:
          return fail(Errc::AuthenticationFailed, "the sensor at %s does not let this host's key in",
                      address.c_str());
        case wire::LinkEvent::HandshakeBroken:
          if (!handshakes.on_broken()) break;  // tried again by itself
          [[fallthrough]];
        case wire::LinkEvent::HandshakeFailed:
          return fail(Errc::AuthenticationFailed, "the sensor at %s and this host do not agree on keys",
                      address.c_str());
        case wire::LinkEvent::Disconnected:
          connected = false;
          break;
        case wire::LinkEvent::ConnectFailed:
          break;  // tried again by itself
      }
    }
    return {};
  }

  Result<void> check_silence() const {
    const HostClock::time_point since = std::max(protocol.heard(), opened);
    if (now() - since <= config.silence_limit) return {};
    const double silence_s = std::chrono::duration<double>(config.silence_limit).count();
    if (!protocol.has_hello()) {
      return fail(Errc::ConnectFailed, "no sensor answers at %s for %.1f s", config.sensor.text().c_str(),
                  silence_s);
    }
    return fail(Errc::ConnectionLost, "the sensor at %s is silent for %.1f s", config.sensor.text().c_str(),
                silence_s);
  }
};

Result<std::unique_ptr<SensorLink>> SensorLink::open(const SensorLinkConfig& config) {
  BITELINE_ASSIGN(wire::SocketContext context, wire::SocketContext::create());
  BITELINE_ASSIGN(wire::Socket caller, wire::open_caller(context, config.sensor, config.keys));
  BITELINE_ASSIGN(wire::Socket watcher, wire::open_watcher(context, caller));
  BITELINE_TRY(caller.connect(config.sensor.text()));
  return std::unique_ptr<SensorLink>{new SensorLink{
      std::make_unique<State>(config, std::move(context), std::move(caller), std::move(watcher))}};
}

SensorLink::SensorLink(std::unique_ptr<State> state) : state_{std::move(state)} {}

SensorLink::~SensorLink() {
  state_->protocol.say_bye();
}

Result<std::optional<LinkEvent>> SensorLink::next(Nanoseconds timeout) {
  const HostClock::time_point deadline = now() + timeout;
  while (true) {
    BITELINE_TRY(state_->follow_connection());
    state_->protocol.tick(now());
    while (const std::optional<wire::Socket::Parts> packet = state_->caller.receive()) {
      const bool well_formed = packet->parts.size() == 1 && packet->surplus_parts == 0;
      state_->last_packet = well_formed ? packet->parts.front() : wire::Bytes{};
      BITELINE_ASSIGN(std::optional<LinkEvent> event, state_->protocol.on_packet(state_->last_packet, now()));
      if (event) return event;
    }
    BITELINE_TRY(state_->check_silence());
    const Nanoseconds left = deadline - now();
    if (left <= Nanoseconds{0}) return std::optional<LinkEvent>{};
    wire::wait_readable({&state_->caller, &state_->watcher}, std::min(left, k_turn));
  }
}

std::span<const std::uint8_t> SensorLink::packet() const {
  return state_->last_packet;
}
void SensorLink::acknowledge() {
  state_->protocol.acknowledge(now());
}
void SensorLink::command(wire::Control control) {
  state_->protocol.command(control);
}
ScanPosition SensorLink::position() const {
  return state_->protocol.position();
}
const LinkCounters& SensorLink::counters() const {
  return state_->protocol.counters();
}
int SensorLink::reconnects() const {
  return std::max(0, state_->connections - 1);
}

}  // namespace biteline::intake
