// SPDX-License-Identifier: MIT
#pragma once
/// \file JSON as text, whatever bytes stand in it.

#include <nlohmann/json.hpp>
#include <string>

namespace biteline::report {

/// A file's name may hold any byte: what is no UTF-8 is replaced, and nothing is thrown.
[[nodiscard]] inline std::string to_text(const nlohmann::ordered_json& json, int indent = 2) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace biteline::report
