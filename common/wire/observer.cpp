// SPDX-License-Identifier: MIT
#include "common/wire/observer.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/wire/socket.hpp"

namespace biteline::wire {
namespace {

using Clock = std::chrono::steady_clock;

/// Between two looks at the connection.
constexpr Nanoseconds k_turn = std::chrono::milliseconds{50};
/// The sensor forgets an observer after 2 s.
constexpr Nanoseconds k_sign_of_life = std::chrono::milliseconds{500};

}  // namespace

struct Observer::State {
  State(ObserverConfig given, SocketContext zmq, Socket socket, Socket events)
      : config{std::move(given)},
        context{std::move(zmq)},
        caller{std::move(socket)},
        watcher{std::move(events)} {}

  ObserverConfig config;
  SocketContext context;
  Socket caller;
  Socket watcher;
  HandshakeRecord handshakes;
  bool linked{false};
  bool answered{false};  ///< on this connection
  bool hello_due{false};
  std::uint64_t rejected{0};
  Clock::time_point linked_at, hello_said;
  Bytes scratch;

  /// An Error: the connection will never come about.
  Result<void> follow_connection() {
    while (const std::optional<LinkEvent> event = next_event(watcher)) {
      const std::string address = config.sensor.text();
      switch (*event) {
        case LinkEvent::Connected:
          handshakes.on_success();
          linked = hello_due = true;
          answered = false;
          linked_at = Clock::now();
          break;
        case LinkEvent::AuthenticationFailed:
          return fail(Errc::AuthenticationFailed, "the sensor at %s does not let this observer's key in",
                      address.c_str());
        case LinkEvent::HandshakeBroken:
          if (!handshakes.on_broken()) break;  // tried again by itself
          [[fallthrough]];
        case LinkEvent::HandshakeFailed:
          return fail(Errc::AuthenticationFailed, "the sensor at %s and this observer do not agree on keys",
                      address.c_str());
        case LinkEvent::Disconnected:
          linked = answered = false;
          break;
        case LinkEvent::ConnectFailed:
          break;  // tried again by itself
      }
    }
    if (linked && !answered && Clock::now() - linked_at > config.patience) {
      return fail(Errc::NotSupported,
                  "the sensor at %s does not answer an observer: it is older than protocol 1.1, update it",
                  config.sensor.text().c_str());
    }
    return {};
  }

  void say_hello_when_due() {
    if (!linked || (!hello_due && Clock::now() - hello_said < k_sign_of_life)) return;
    hello_due = false;
    hello_said = Clock::now();
    encode({.body = config.wish}, scratch);
    caller.send({scratch});
  }

  Result<std::optional<Message>> on_packet(const Socket::Parts& packet) {
    const bool well_formed = packet.parts.size() == 1 && packet.surplus_parts == 0;
    Result<Message> message = decode(well_formed ? packet.parts.front() : Bytes{});
    if (!message) {
      if (message.error().code == Errc::NotSupported) return tl::unexpected<Error>{message.error()};
      ++rejected;
      return std::optional<Message>{};
    }
    if (const Bye* bye = std::get_if<Bye>(&message->body)) {
      if (bye->reason == ByeReason::VersionMismatch)
        return fail(Errc::NotSupported, "sensor: %s", bye->text.c_str());
      if (bye->reason == ByeReason::Refused) return fail(Errc::PeerRefused, "sensor: %s", bye->text.c_str());
    }
    answered = answered || std::holds_alternative<SensorHello>(message->body);
    if (std::holds_alternative<profile::Profile>(message->body) ||
        std::holds_alternative<Picture>(message->body)) {
      // The sensor sends the next only when this one has been taken.
      ++config.wish.received;
      hello_due = true;
    }
    return std::optional<Message>{std::move(*message)};
  }
};

Result<std::unique_ptr<Observer>> Observer::open(const ObserverConfig& config) {
  BITELINE_ASSIGN(SocketContext context, SocketContext::create());
  BITELINE_ASSIGN(Socket caller, open_caller(context, config.sensor, config.keys));
  BITELINE_ASSIGN(Socket watcher, open_watcher(context, caller));
  BITELINE_TRY(caller.connect(config.sensor.text()));
  return std::unique_ptr<Observer>{new Observer{
      std::make_unique<State>(config, std::move(context), std::move(caller), std::move(watcher))}};
}

Observer::Observer(std::unique_ptr<State> state) : state_{std::move(state)} {}

Observer::~Observer() {
  if (!state_->linked) return;
  encode({.body = Bye{.reason = ByeReason::Stopping, .text = "the observer leaves"}}, state_->scratch);
  state_->caller.send({state_->scratch});
}

Result<std::optional<Message>> Observer::next(Nanoseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  while (true) {
    BITELINE_TRY(state_->follow_connection());
    state_->say_hello_when_due();
    while (const std::optional<Socket::Parts> packet = state_->caller.receive()) {
      BITELINE_ASSIGN(std::optional<Message> message, state_->on_packet(*packet));
      if (message) return message;
    }
    const Nanoseconds left = deadline - Clock::now();
    if (left <= Nanoseconds{0}) return std::optional<Message>{};
    wait_readable({&state_->caller, &state_->watcher}, std::min(left, k_turn));
  }
}

void Observer::wish_for(const PictureWish& picture) {
  state_->config.wish.picture = picture;
  state_->hello_due = true;
}

void Observer::wish_for_profiles(double rate_hz) {
  state_->config.wish.profile_rate_hz = rate_hz;
  state_->hello_due = true;
}

bool Observer::connected() const {
  return state_->answered;
}

std::uint64_t Observer::rejected() const {
  return state_->rejected;
}

}  // namespace biteline::wire
