// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/routes.hpp"

#include <algorithm>
#include <array>
#include <optional>

namespace biteline::web {
namespace {

constexpr std::array k_routes{
    Route{"GET", "/api/v1/openapi.yaml", Handling::Openapi},
    Route{"GET", "/api/v1/state", Handling::Forward},
    Route{"POST", "/api/v1/sessions", Handling::Login},
    Route{"DELETE", "/api/v1/sessions", Handling::Logout},
    Route{"GET", "/api/v1/me", Handling::Forward},
    Route{"GET", "/api/v1/control", Handling::Forward},
    Route{"POST", "/api/v1/control", Handling::Forward},
    Route{"GET", "/api/v1/scans", Handling::Forward},
    Route{"GET", "/api/v1/scans/{id}", Handling::Forward},
    Route{"GET", "/api/v1/scans/{id}/files", Handling::FileList},
    Route{"GET", "/api/v1/scans/{id}/files/{path}", Handling::File},
    Route{"POST", "/api/v1/scans/{id}/accept", Handling::Forward},
    Route{"POST", "/api/v1/scans/{id}/reject", Handling::Forward},
    Route{"POST", "/api/v1/scans/{id}/send", Handling::Forward},
    Route{"POST", "/api/v1/scans/{id}/hold", Handling::Forward},
    Route{"POST", "/api/v1/scans/{id}/keep", Handling::Forward},
    Route{"POST", "/api/v1/scans/{id}/rerun", Handling::Forward},
    Route{"POST", "/api/v1/scans/{id}/model", Handling::Forward},
    Route{"POST", "/api/v1/scans/{id}/process", Handling::Forward},
    Route{"POST", "/api/v1/scans/{id}/air", Handling::Forward},
    Route{"POST", "/api/v1/scans/{id}/mend", Handling::Forward},
    Route{"POST", "/api/v1/commands/start", Handling::Forward},
    Route{"POST", "/api/v1/commands/stop", Handling::Forward},
    Route{"POST", "/api/v1/commands/laser-off", Handling::Forward},
    Route{"POST", "/api/v1/commands/rescan", Handling::Forward},
    Route{"GET", "/api/v1/models", Handling::Forward},
    Route{"POST", "/api/v1/models", Handling::Forward},
    Route{"POST", "/api/v1/model-files", Handling::Upload},
    Route{"GET", "/api/v1/models/{name}", Handling::Forward},
    Route{"GET", "/api/v1/models/{name}/file", Handling::Forward},
    Route{"DELETE", "/api/v1/models/{name}", Handling::Forward},
    Route{"GET", "/api/v1/processes", Handling::Forward},
    Route{"GET", "/api/v1/processes/schema", Handling::Forward},
    Route{"POST", "/api/v1/processes/check", Handling::Forward},
    Route{"GET", "/api/v1/processes/{name}", Handling::Forward},
    Route{"PUT", "/api/v1/processes/{name}", Handling::Forward},
    Route{"GET", "/api/v1/mounted", Handling::Forward},
    Route{"POST", "/api/v1/mounted/touches", Handling::Forward},
    Route{"DELETE", "/api/v1/mounted/touches", Handling::Forward},
    Route{"PUT", "/api/v1/mounted/{part}", Handling::Forward},
    Route{"DELETE", "/api/v1/mounted/{part}", Handling::Forward},
    Route{"GET", "/api/v1/robots", Handling::Forward},
    Route{"GET", "/api/v1/sensors", Handling::Forward},
    Route{"PATCH", "/api/v1/sensors/settings", Handling::Forward},
    Route{"POST", "/api/v1/sensors/keep", Handling::Forward},
    Route{"GET", "/api/v1/users", Handling::Forward},
    Route{"POST", "/api/v1/users", Handling::Forward},
    Route{"PATCH", "/api/v1/users/{user}", Handling::Forward},
    Route{"DELETE", "/api/v1/users/{user}", Handling::Forward},
    Route{"GET", "/api/v1/log", Handling::Forward},
    Route{"GET", "/api/v1/history/trends", Handling::Forward},
    Route{"GET", "/api/v1/history.csv", Handling::Forward},
    Route{"GET", "/api/v1/fleet/cells", Handling::Forward},
    Route{"GET", "/api/v1/fleet/scans", Handling::Forward},
    Route{"GET", "/api/v1/fleet/trends", Handling::Forward},
    Route{"GET", "/api/v1/fleet/groups", Handling::Forward},
    Route{"GET", "/api/v1/fleet/alarms", Handling::Forward},
    Route{"GET", "/api/v1/fleet/odd", Handling::Forward},
    Route{"GET", "/api/v1/fleet/releases", Handling::Forward},
    Route{"GET", "/api/v1/fleet/fetches", Handling::Forward},
    Route{"POST", "/api/v1/fleet/fetches", Handling::Forward},
    Route{"POST", "/api/v1/fleet/marks", Handling::Forward},
    Route{"GET", "/api/v1/events", Handling::Events},
    Route{"GET", "/api/v1/live", Handling::Live},
    Route{"GET", "/metrics", Handling::Metrics},
    Route{"GET", "/foxglove", Handling::Foxglove},
};

/// What the pattern's names stand for in `path`; nothing where it does not fit.
std::optional<std::map<std::string, std::string>> fit(std::string_view pattern, std::string_view path) {
  std::map<std::string, std::string> named;
  while (!pattern.empty() && !path.empty()) {
    if (pattern.front() != '{') {
      if (pattern.front() != path.front()) return std::nullopt;
      pattern.remove_prefix(1);
      path.remove_prefix(1);
      continue;
    }
    const std::size_t end = pattern.find('}');
    const std::string name{pattern.substr(1, end - 1)};
    pattern.remove_prefix(end + 1);
    const std::size_t length = name == "path" ? path.size() : std::min(path.find('/'), path.size());
    if (length == 0) return std::nullopt;
    named[name] = path.substr(0, length);
    path.remove_prefix(length);
  }
  if (!pattern.empty() || !path.empty()) return std::nullopt;
  return named;
}

}  // namespace

std::span<const Route> routes() {
  return k_routes;
}

RouteMatch find_route(std::string_view method, std::string_view path) {
  RouteMatch match;
  std::string_view best;
  for (const Route& route : k_routes) {
    auto named = fit(route.pattern, path);
    if (!named) continue;
    // "/processes/schema" is no process of that name: the pattern with the fewest names wins.
    const bool closer =
        best.empty() || std::ranges::count(route.pattern, '{') < std::ranges::count(best, '{');
    if (closer) {
      best = route.pattern;
      match = {};
    } else if (route.pattern != best) {
      continue;
    }
    match.methods.push_back(route.method);
    if (route.method == method) {
      match.route = &route;
      match.named = std::move(*named);
    }
  }
  return match;
}

bool is_scan_name(std::string_view name) {
  constexpr std::string_view k_prefix = "scan-";
  if (!name.starts_with(k_prefix)) return false;
  name.remove_prefix(k_prefix.size());
  return name.size() >= 4 && name.size() <= 9 &&
         std::ranges::all_of(name, [](char letter) { return letter >= '0' && letter <= '9'; });
}

}  // namespace biteline::web
