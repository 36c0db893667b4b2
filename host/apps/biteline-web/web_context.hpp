// SPDX-License-Identifier: MIT
#pragma once
/// \file What all connections of one server share.

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/biteline-web/beast.hpp"
#include "host/apps/biteline-web/live_feed.hpp"
#include "host/apps/biteline-web/login_limit.hpp"
#include "host/apps/biteline-web/metrics.hpp"
#include "host/apps/biteline-web/places.hpp"
#include "host/apps/biteline-web/web_server.hpp"
#include "host/apps/biteline-web/web_stream.hpp"

namespace biteline::web {

/// Thread: the event loop's, but for `watchers`.
struct WebContext {
  WebConfig config;
  std::vector<std::string> host_names;  ///< that a request's Host may be
  std::unique_ptr<ServiceDoor> door;
  std::optional<net::ssl::context> tls;
  LiveFeed feed;
  LoginLimit login_limit;
  std::filesystem::path results;   ///< empty until the service has said it
  std::filesystem::path accounts;  ///< where the first account's token is; likewise
  Places places{0, 0, 0};
  std::map<Places::Id, WebStream*> streams;  ///< of who has a place
  int turned_away{0};                        ///< who are being told that there is none
  std::uint64_t requests{0};
  std::uint64_t refused{0};
  std::uint64_t forwarded{0};
  std::uint64_t host_away{0};
  std::atomic<int> watchers{0};  ///< of the live data; read by others, too

  [[nodiscard]] ServerCounts counts();
};

/// One client from its first byte to its last.
[[nodiscard]] net::awaitable<void> serve_connection(WebContext& context, Tcp::socket socket);

}  // namespace biteline::web
