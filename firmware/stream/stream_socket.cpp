// SPDX-License-Identifier: MIT
#include "firmware/stream/stream_socket.hpp"

#include <algorithm>
#include <utility>

namespace biteline::stream {

namespace {

constexpr std::chrono::seconds k_look_at_list{1};

/// What changes when somebody writes the list.
std::filesystem::file_time_type changed_at(const std::filesystem::path& folder) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(folder / "hosts.allowed", error);
  return error ? std::filesystem::file_time_type::min() : time;
}

}  // namespace

Result<std::unique_ptr<StreamSocket>> StreamSocket::open(Config config) {
  BITELINE_ASSIGN(wire::SocketContext context, wire::SocketContext::create());
  std::optional<wire::Socket> gatekeeper;
  if (config.keys) {
    BITELINE_ASSIGN(gatekeeper, wire::open_gatekeeper(context));
  }
  const std::optional<wire::KeyPair> own =
      config.keys ? std::optional<wire::KeyPair>{config.keys->own} : std::nullopt;
  BITELINE_ASSIGN(wire::Socket listener,
                  wire::open_listener(context, config.listen, own, gatekeeper ? &*gatekeeper : nullptr));
  BITELINE_ASSIGN(std::string address, listener.bound_address());
  return std::unique_ptr<StreamSocket>{new StreamSocket{
      std::move(config), std::move(context), std::move(gatekeeper), std::move(listener), std::move(address)}};
}

StreamSocket::StreamSocket(Config config, wire::SocketContext context, std::optional<wire::Socket> gatekeeper,
                           wire::Socket listener, std::string address)
    : config_{std::move(config)},
      context_{std::move(context)},
      gatekeeper_{std::move(gatekeeper)},
      listener_{std::move(listener)},
      address_{std::move(address)} {
  if (config_.keys) list_changed_at_ = changed_at(config_.keys->folder);
}

void StreamSocket::heed_allow_list() {
  if (!config_.keys || config_.keys->folder.empty()) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < look_at_list_) return;
  look_at_list_ = now + k_look_at_list;
  const auto time = changed_at(config_.keys->folder);
  if (time != list_changed_at_) {
    Result<std::vector<std::string>> allowed = wire::read_allowed_hosts(config_.keys->folder);
    // Half written, or gone for a moment: the list that was good holds until a good one is there.
    if (!allowed) return;
    list_changed_at_ = time;
    const auto still_in = [&](const std::string& key) {
      return std::ranges::find(*allowed, key) != allowed->end();
    };
    // libzmq asks once, at the handshake.  So whoever is out now is put out with everybody, and not let in
    // again; the others come back by themselves within a second and go on where they were.
    shut_out_ = shut_out_ || !std::ranges::all_of(config_.keys->allowed_hosts, still_in);
    config_.keys->allowed_hosts = std::move(*allowed);
  }
  if (!shut_out_) return;
  const Result<wire::Endpoint> same_port = wire::parse_endpoint(address_);
  if (!same_port) return;
  if (listening_) listener_.unbind(address_);
  listening_ = false;
  Result<wire::Socket> listener = wire::open_listener(context_, *same_port, config_.keys->own, &*gatekeeper_);
  if (!listener) {
    // The port is not free yet.
    look_at_list_ = now + std::chrono::milliseconds{50};
    return;
  }
  listener_ = std::move(*listener);
  listening_ = true;
  shut_out_ = false;
}

bool StreamSocket::send(const PeerId& peer, std::span<const std::uint8_t> packet) {
  return listener_.send({{reinterpret_cast<const std::uint8_t*>(peer.data()), peer.size()}, packet});
}

int StreamSocket::receive(Nanoseconds timeout, const Sink& sink) {
  int refused = 0;
  heed_allow_list();
  if (gatekeeper_) {
    wire::wait_readable({&listener_, &*gatekeeper_}, timeout);
    refused = wire::serve_gatekeeper(*gatekeeper_, config_.keys->allowed_hosts);
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
