// SPDX-License-Identifier: MIT
#pragma once
/// \file A report that another program wrote.

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace biteline::demo {

/// An empty object where there is none to read.
inline nlohmann::ordered_json read_json(const std::filesystem::path& file) {
  std::ifstream stream(file);
  nlohmann::ordered_json value = nlohmann::ordered_json::parse(stream, nullptr, false);
  return value.is_object() ? value : nlohmann::ordered_json::object();
}

}  // namespace biteline::demo
