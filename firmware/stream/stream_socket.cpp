// SPDX-License-Identifier: MIT
#include "firmware/stream/stream_socket.hpp"

#include <utility>

namespace biteline::stream {

Result<std::unique_ptr<StreamSocket>> StreamSocket::open(Config config) {
  BITELINE_ASSIGN(wire::SocketContext context, wire::SocketContext::create());
  std::optional<wire::Socket> gatekeeper;
  std::optional<wire::KeyPair> own;
  std::vector<std::string> allowed_hosts;
  if (config.keys) {
    BITELINE_ASSIGN(gatekeeper, wire::open_gatekeeper(context));
    own = config.keys->own;
    allowed_hosts = config.keys->allowed_hosts;
  }
  BITELINE_ASSIGN(wire::Socket listener,
                  wire::open_listener(context, config.listen, own, gatekeeper ? &*gatekeeper : nullptr));
  BITELINE_ASSIGN(std::string address, listener.bound_address());
  return std::unique_ptr<StreamSocket>{new StreamSocket{std::move(context), std::move(gatekeeper),
                                                        std::move(listener), std::move(address),
                                                        std::move(allowed_hosts)}};
}

StreamSocket::StreamSocket(wire::SocketContext context, std::optional<wire::Socket> gatekeeper,
                           wire::Socket listener, std::string address, std::vector<std::string> allowed_hosts)
    : context_{std::move(context)},
      gatekeeper_{std::move(gatekeeper)},
      listener_{std::move(listener)},
      address_{std::move(address)},
      allowed_hosts_{std::move(allowed_hosts)} {}

bool StreamSocket::send(const PeerId& peer, std::span<const std::uint8_t> packet) {
  return listener_.send({{reinterpret_cast<const std::uint8_t*>(peer.data()), peer.size()}, packet});
}

int StreamSocket::receive(Nanoseconds timeout, const Sink& sink) {
  int refused = 0;
  if (gatekeeper_) {
    wire::wait_readable({&listener_, &*gatekeeper_}, timeout);
    refused = wire::serve_gatekeeper(*gatekeeper_, allowed_hosts_);
  } else {
    wire::wait_readable({&listener_}, timeout);
  }
  for (int packets = 0; packets < k_batch; ++packets) {
    const std::optional<wire::Socket::Parts> message = listener_.receive();
    if (!message) break;
    const auto& parts = message->parts;
    const PeerId peer{parts.front().begin(), parts.front().end()};
    const bool well_formed = parts.size() == 2 && message->surplus_parts == 0;
    sink(peer, well_formed ? std::span<const std::uint8_t>{parts[1]} : std::span<const std::uint8_t>{});
  }
  return refused;
}

}  // namespace biteline::stream
