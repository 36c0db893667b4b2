// SPDX-License-Identifier: MIT
#pragma once
/// \file Routes of the API, as make_routes.py makes them of its documents, and how one is found.

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/interfaces/accounts/accounts.hpp"

namespace biteline::api {

/// An operation of openapi.yaml or between_programs.yaml.
struct Route {
  std::string_view method;
  std::string_view pattern;            ///< from the root: "/api/v1/scans/{id}"
  std::string_view operation;          ///< its operationId
  std::optional<accounts::Role> role;  ///< the least that may; nothing: the handler sees who may
  bool control;                        ///< who asks must hold control
  bool local;                          ///< the cell's own machine needs no session
  bool is_long;                        ///< it takes seconds, for which no other request waits
  bool changes;                        ///< an event `log` follows
};

/// What stands in `path` where the pattern has names, in order; nothing where it does not fit.  Only {path}
/// may hold slashes.
[[nodiscard]] std::optional<std::vector<std::string>> fit(std::string_view pattern, std::string_view path);

/// `Row` is a Route with what a program does with it.
template <class Row>
struct Match {
  const Row* route{nullptr};              ///< null: none of this path and method
  std::vector<std::string> names;         ///< what stands in the path's braces, in order
  std::vector<std::string_view> methods;  ///< that this path has
};

template <class Row>
[[nodiscard]] Match<Row> find_route(std::span<const Row> rows, std::string_view method,
                                    std::string_view path) {
  Match<Row> match;
  std::string_view best;
  for (const Row& row : rows) {
    auto names = fit(row.pattern, path);
    if (!names) continue;
    // "/processes/schema" is no process of that name: the pattern with the fewest names wins.
    const bool closer = best.empty() || std::ranges::count(row.pattern, '{') < std::ranges::count(best, '{');
    if (closer) {
      best = row.pattern;
      match = {};
    } else if (row.pattern != best) {
      continue;
    }
    match.methods.push_back(row.method);
    if (row.method == method) {
      match.route = &row;
      match.names = std::move(*names);
    }
  }
  return match;
}

}  // namespace biteline::api
