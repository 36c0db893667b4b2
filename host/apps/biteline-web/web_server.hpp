// SPDX-License-Identifier: MIT
#pragma once
/// \file The web server: one event loop for HTTP, WebSocket and TLS.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/apps/biteline-web/live_messages.hpp"
#include "host/apps/biteline-web/service_door.hpp"

namespace biteline::web {

/// What one client may take of the server.
struct WebLimits {
  std::uint32_t header_bytes{8 * 1024};
  std::uint64_t body_bytes{256 * 1024};
  std::uint64_t upload_bytes{256U << 20U};          ///< of a model's file; the service takes no more, too
  std::chrono::milliseconds request_time{10'000};   ///< from its first byte to its last; a piece of a file
  std::chrono::milliseconds answer_time{60'000};    ///< for the client to take one piece of the answer
  std::chrono::milliseconds first_time{5'000};      ///< to the first byte of all, TLS included
  std::chrono::milliseconds idle_time{60'000};      ///< between two requests
  std::chrono::milliseconds session_check{10'000};  ///< how often a WebSocket's session is looked at again
  int connections{256};
  int connections_an_address{128};
  int kept_for_local{16};  ///< beyond `connections`, for this machine's own
};

struct TlsFiles {
  std::filesystem::path certificate;  ///< PEM, with the chain
  std::filesystem::path key;          ///< PEM
};

struct WebConfig {
  std::string address{"127.0.0.1"};  ///< number, IPv6 without brackets
  std::uint16_t port{8080};          ///< 0: any free one
  std::optional<TlsFiles> tls;       ///< compulsory beyond loopback
  std::vector<std::string> names;  ///< under which it may be called besides its address, e.g. cell-3.example
  std::filesystem::path page;      ///< folder of the page
  std::filesystem::path openapi;   ///< file
  bool behind_proxy{false};        ///< nobody counts as on the cell's own machine
  WebLimits limits;
};

/// Thread: run() owns everything; the others are safe from any thread.
class WebServer {
 public:
  /// Listens when it returns.  `on_event` hears every event of the service, on the server's thread.
  /// Errc::AuthenticationFailed: an address beyond loopback without TLS; Errc::PeerRefused: the port is
  /// taken.
  [[nodiscard]] static Result<std::unique_ptr<WebServer>> open(const WebConfig& config,
                                                               std::unique_ptr<ServiceDoor> door,
                                                               ServiceDoor::OnEvent on_event = {});
  ~WebServer();

  /// "http://127.0.0.1:8080"
  [[nodiscard]] std::string address() const;
  [[nodiscard]] std::uint16_t port() const;

  /// Until stop().
  void run();
  void stop();

  /// How many watch the live data.
  [[nodiscard]] int watchers() const;
  /// To all who watch; returns at once.
  void publish(LiveKind kind, LiveBytes bytes);
  /// A scan begins: what is shown of the one before goes.
  void forget_scan();

 private:
  struct State;
  explicit WebServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::web
