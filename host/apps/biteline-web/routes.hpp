// SPDX-License-Identifier: MIT
#pragma once
/// \file Every path of the API (host/web/openapi.yaml), and who answers it.

#include <span>
#include <string_view>

#include "host/interfaces/api/routes.hpp"

namespace biteline::web {

enum class Handling {
  Forward,   ///< by the service
  Login,     ///< by the service; the answer's token may become a cookie
  Logout,    ///< by the service; the cookie goes
  Upload,    ///< by the service, in pieces: a file of any size
  FileList,  ///< by this program, from the results folder
  File,      ///< the same
  Openapi,   ///< by this program, without a session
  Events,    ///< WebSocket
  Live,      ///< WebSocket
  Foxglove,  ///< WebSocket, outside /api
  Metrics,   ///< by this program, outside /api
};

struct Route : api::Route {
  Handling handling;
};
using RouteMatch = api::Match<Route>;

[[nodiscard]] std::span<const Route> routes();
/// `path` is decoded.
[[nodiscard]] RouteMatch find_route(std::string_view method, std::string_view path);

/// As the service names scans: "scan-" and 4 to 9 digits.
[[nodiscard]] bool is_scan_name(std::string_view name);

}  // namespace biteline::web
