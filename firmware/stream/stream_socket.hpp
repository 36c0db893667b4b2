// SPDX-License-Identifier: MIT
#pragma once
/// \file The sensor's network end: a listener, and with keys the gatekeeper beside it.

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/wire/socket.hpp"
#include "firmware/stream/stream_server.hpp"

namespace biteline::stream {

/// hosts.allowed is looked at again every second: who is taken out of it is cut off, who is put in may come.
/// Thread: one owner (the stream thread) after open().
class StreamSocket final : public Outbox {
 public:
  struct Config {
    wire::Endpoint listen{.host = "127.0.0.1", .port = 0};
    std::optional<wire::SensorKeys> keys;  ///< compulsory beyond loopback
  };
  /// What arrived from `peer`.  An empty packet stands for one of the wrong shape.
  using Sink = std::function<void(const PeerId& peer, std::span<const std::uint8_t> packet)>;

  [[nodiscard]] static Result<std::unique_ptr<StreamSocket>> open(Config config);

  /// Where it listens, with the real port.
  [[nodiscard]] const std::string& address() const { return address_; }

  bool send(const PeerId& peer, std::span<const std::uint8_t> packet) override;

  /// Waits at most `timeout` for something to arrive, gives the sink what is there (at most `k_batch`
  /// packets), and returns how many strangers were turned away.
  int receive(Nanoseconds timeout, const Sink& sink);

  /// Bounds one call's work whatever arrives: some four windows of acknowledgements.
  static constexpr int k_batch = 256;

 private:
  StreamSocket(Config config, wire::SocketContext context, std::optional<wire::Socket> gatekeeper,
               wire::Socket listener, std::string address);
  void heed_allow_list();

  Config config_;
  wire::SocketContext context_;
  std::optional<wire::Socket> gatekeeper_;
  wire::Socket listener_;
  std::string address_;
  std::filesystem::file_time_type list_changed_at_{};
  std::chrono::steady_clock::time_point look_at_list_{};
  bool shut_out_{false};  ///< somebody in the old list is not in the new one, and may still be connected
  bool listening_{true};
};

}  // namespace biteline::stream
