// SPDX-License-Identifier: MIT
#include "host/interfaces/api/routes.hpp"

namespace biteline::api {

std::optional<std::vector<std::string>> fit(std::string_view pattern, std::string_view path) {
  std::vector<std::string> names;
  while (!pattern.empty() && !path.empty()) {
    if (pattern.front() != '{') {
      if (pattern.front() != path.front()) return std::nullopt;
      pattern.remove_prefix(1);
      path.remove_prefix(1);
      continue;
    }
    const std::size_t end = pattern.find('}');
    const bool whole = pattern.substr(1, end - 1) == "path";
    pattern.remove_prefix(end + 1);
    const std::size_t length = whole ? path.size() : std::min(path.find('/'), path.size());
    if (length == 0) return std::nullopt;
    names.emplace_back(path.substr(0, length));
    path.remove_prefix(length);
  }
  if (!pattern.empty() || !path.empty()) return std::nullopt;
  return names;
}

}  // namespace biteline::api
