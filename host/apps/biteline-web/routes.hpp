// SPDX-License-Identifier: MIT
#pragma once
/// \file Every path of the API (host/web/openapi.yaml), and who answers it.

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

struct Route {
  std::string_view method;
  std::string_view pattern;  ///< as in the OpenAPI file, from the root: "/api/v1/scans/{id}"
  Handling handling;
};

[[nodiscard]] std::span<const Route> routes();

struct RouteMatch {
  const Route* route{nullptr};               ///< null: none of this path and method
  std::map<std::string, std::string> named;  ///< {id}, {name}, {path}: the last may hold slashes
  std::vector<std::string_view> methods;     ///< that this path has
};
/// `path` is decoded.
[[nodiscard]] RouteMatch find_route(std::string_view method, std::string_view path);

/// As the service names scans: "scan-" and 4 to 9 digits.
[[nodiscard]] bool is_scan_name(std::string_view name);

}  // namespace biteline::web
