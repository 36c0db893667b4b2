// SPDX-License-Identifier: MIT
#pragma once
/// \file One client over WebSocket: events or live data, until it or its session ends.

#include <string>

#include "host/apps/biteline-web/answers.hpp"
#include "host/apps/biteline-web/routes.hpp"
#include "host/apps/biteline-web/web_context.hpp"
#include "host/apps/biteline-web/web_stream.hpp"

namespace biteline::web {

struct WatcherRequest {
  WebStream& stream;
  const WebRequest& request;  ///< asks for the upgrade
  Handling handling{Handling::Events};
  std::string session;  ///< valid; looked at again now and then
  bool local{false};
};

/// Thread: the event loop's.
[[nodiscard]] net::awaitable<void> serve_watcher(WebContext& context, WatcherRequest watcher);

}  // namespace biteline::web
