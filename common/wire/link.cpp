// SPDX-License-Identifier: MIT
// Listener, caller, gatekeeper and watcher: how the two sides' sockets are set up.
#include <zmq.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "common/core/contracts.hpp"
#include "common/wire/socket.hpp"

namespace biteline::wire {
namespace {

constexpr const char* k_zap_address = "inproc://zeromq.zap.01";  // fixed by RFC 27
constexpr const char* k_zap_domain = "biteline";

/// Queue per peer.  The protocol's window (64 messages) stays below it, so that a full queue means a peer
/// that does not read.
constexpr int k_queue_messages = 256;
/// A dead connection (cable, power) is noticed within these; both sides' own silence rules are slower.
constexpr int k_heartbeat_ms = 500;
constexpr int k_heartbeat_timeout_ms = 2000;
constexpr int k_handshake_ms = 3000;
constexpr int k_reconnect_ms = 50;
constexpr int k_reconnect_max_ms = 1000;

Result<void> set_common_options(Socket& socket, const Endpoint& endpoint) {
  BITELINE_TRY(socket.set(ZMQ_SNDHWM, k_queue_messages));
  BITELINE_TRY(socket.set(ZMQ_RCVHWM, k_queue_messages));
  BITELINE_TRY(socket.set(ZMQ_HEARTBEAT_IVL, k_heartbeat_ms));
  BITELINE_TRY(socket.set(ZMQ_HEARTBEAT_TIMEOUT, k_heartbeat_timeout_ms));
  BITELINE_TRY(socket.set(ZMQ_HANDSHAKE_IVL, k_handshake_ms));
  const std::int64_t max_bytes = k_max_message_bytes;
  if (zmq_setsockopt(socket.handle(), ZMQ_MAXMSGSIZE, &max_bytes, sizeof max_bytes) != 0) {
    return fail_errno(Errc::DeviceError, zmq_errno(), "zmq_setsockopt MAXMSGSIZE");
  }
  return socket.set(ZMQ_IPV6, endpoint.host.front() == '[' ? 1 : 0);
}

Result<void> demand_keys_beyond_loopback(const Endpoint& endpoint, bool has_keys) {
  if (has_keys || endpoint.loopback()) return {};
  return fail(Errc::AuthenticationFailed, "%s is beyond loopback: keys are compulsory there (--keys DIR)",
              endpoint.text().c_str());
}

std::string_view view(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

bool is_allowed(const Bytes& key, const std::vector<std::string>& allowed) {
  return std::any_of(allowed.begin(), allowed.end(), [&](const std::string& z85) {
    std::array<std::uint8_t, 32> raw{};
    return zmq_z85_decode(raw.data(), z85.c_str()) != nullptr && std::ranges::equal(raw, key);
  });
}

}  // namespace

Result<Socket> open_listener(const SocketContext& context, const Endpoint& endpoint,
                             const std::optional<KeyPair>& own, const Socket* gatekeeper) {
  // libzmq lets every CURVE key in when nobody is there to be asked.
  BITELINE_EXPECTS(!own || gatekeeper != nullptr);
  BITELINE_TRY(demand_keys_beyond_loopback(endpoint, own.has_value()));
  BITELINE_ASSIGN(Socket socket, Socket::open(context, SocketKind::Listener));
  BITELINE_TRY(set_common_options(socket, endpoint));
  // Sending to a peer that is gone or full must say so instead of dropping silently.
  BITELINE_TRY(socket.set(ZMQ_ROUTER_MANDATORY, 1));
  if (own) {
    BITELINE_TRY(socket.set(ZMQ_CURVE_SERVER, 1));
    BITELINE_TRY(socket.set(ZMQ_CURVE_SECRETKEY, own->secret_key));
    BITELINE_TRY(socket.set(ZMQ_ZAP_DOMAIN, std::string{k_zap_domain}));
  }
  const std::string port = endpoint.port == 0 ? "*" : std::to_string(endpoint.port);
  BITELINE_TRY(socket.bind("tcp://" + endpoint.host + ":" + port));
  return socket;
}

Result<Socket> open_gatekeeper(const SocketContext& context) {
  BITELINE_ASSIGN(Socket socket, Socket::open(context, SocketKind::Gatekeeper));
  BITELINE_TRY(socket.bind(k_zap_address));
  return socket;
}

int serve_gatekeeper(Socket& gatekeeper, const std::vector<std::string>& allowed) {
  int refused = 0;
  // Request: version, id, domain, address, identity, mechanism, the peer's public key (RFC 27).
  while (const std::optional<Socket::Parts> request = gatekeeper.receive()) {
    const auto& parts = request->parts;
    const bool well_formed = parts.size() == 7 && view(parts[0]) == "1.0";
    const bool welcome = well_formed && view(parts[2]) == k_zap_domain && view(parts[5]) == "CURVE" &&
                         is_allowed(parts[6], allowed);
    if (!welcome) ++refused;
    const Bytes id = parts.size() > 1 ? parts[1] : Bytes{};
    const bool answered = gatekeeper.send({bytes_of("1.0"),
                                           id,
                                           bytes_of(welcome ? "200" : "400"),
                                           bytes_of(welcome ? "OK" : "key not in hosts.allowed"),
                                           {},
                                           {}});
    if (!answered) break;
  }
  return refused;
}

Result<Socket> open_caller(const SocketContext& context, const Endpoint& endpoint,
                           const std::optional<HostKeys>& keys) {
  BITELINE_TRY(demand_keys_beyond_loopback(endpoint, keys.has_value()));
  BITELINE_ASSIGN(Socket socket, Socket::open(context, SocketKind::Caller));
  BITELINE_TRY(set_common_options(socket, endpoint));
  BITELINE_TRY(socket.set(ZMQ_RECONNECT_IVL, k_reconnect_ms));
  BITELINE_TRY(socket.set(ZMQ_RECONNECT_IVL_MAX, k_reconnect_max_ms));
  // Not ZMQ_IMMEDIATE: it would throw away what has arrived and was not read yet when the peer hangs up,
  // farewells above all.
  if (keys) {
    BITELINE_TRY(socket.set(ZMQ_CURVE_SERVERKEY, keys->sensor_public_key));
    BITELINE_TRY(socket.set(ZMQ_CURVE_PUBLICKEY, keys->own.public_key));
    BITELINE_TRY(socket.set(ZMQ_CURVE_SECRETKEY, keys->own.secret_key));
  }
  return socket;
}

Result<Socket> open_watcher(const SocketContext& context, const Socket& caller) {
  constexpr int k_events = ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED |
                           ZMQ_EVENT_HANDSHAKE_FAILED_AUTH | ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL |
                           ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL | ZMQ_EVENT_CONNECT_RETRIED;
  char address[64];
  std::snprintf(address, sizeof address, "inproc://watch-%p", caller.handle());
  if (zmq_socket_monitor(caller.handle(), address, k_events) != 0) {
    return fail_errno(Errc::DeviceError, zmq_errno(), "zmq_socket_monitor");
  }
  BITELINE_ASSIGN(Socket watcher, Socket::open(context, SocketKind::Watcher));
  BITELINE_TRY(watcher.connect(address));
  return watcher;
}

std::optional<LinkEvent> next_event(Socket& watcher) {
  while (const std::optional<Socket::Parts> event = watcher.receive()) {
    // First part: 16 bit event, 32 bit value; second part: address.
    if (event->parts.empty() || event->parts.front().size() < 2) continue;
    std::uint16_t kind = 0;
    std::memcpy(&kind, event->parts.front().data(), sizeof kind);
    switch (kind) {
      case ZMQ_EVENT_HANDSHAKE_SUCCEEDED:
        return LinkEvent::Connected;
      case ZMQ_EVENT_DISCONNECTED:
        return LinkEvent::Disconnected;
      case ZMQ_EVENT_HANDSHAKE_FAILED_AUTH:
        return LinkEvent::AuthenticationFailed;
      case ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL:
        return LinkEvent::HandshakeFailed;
      case ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL:
        return LinkEvent::HandshakeBroken;
      case ZMQ_EVENT_CONNECT_RETRIED:
        return LinkEvent::ConnectFailed;
      default:
        break;
    }
  }
  return std::nullopt;
}

}  // namespace biteline::wire
