// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/routes.hpp"

#include <algorithm>
#include <array>

namespace biteline::web {

std::span<const Route> routes() {
  static constexpr std::array k_routes{
#include "host/interfaces/api/web_routes.inc"
  };
  return k_routes;
}

RouteMatch find_route(std::string_view method, std::string_view path) {
  return api::find_route(routes(), method, path);
}

bool is_scan_name(std::string_view name) {
  constexpr std::string_view k_prefix = "scan-";
  if (!name.starts_with(k_prefix)) return false;
  name.remove_prefix(k_prefix.size());
  return name.size() >= 4 && name.size() <= 9 &&
         std::ranges::all_of(name, [](char letter) { return letter >= '0' && letter <= '9'; });
}

}  // namespace biteline::web
