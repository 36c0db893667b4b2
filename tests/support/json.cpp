// SPDX-License-Identifier: MIT
#include "tests/support/json.hpp"

#include <fstream>

namespace biteline::test {

nlohmann::json read_json(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, false);
}

nlohmann::json read_json(std::istream& stream) {
  return nlohmann::json::parse(stream, nullptr, false);
}

nlohmann::json read_json_file(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return read_json(stream);
}

nlohmann::ordered_json read_ordered_json(std::istream& stream) {
  return nlohmann::ordered_json::parse(stream, nullptr, false);
}

std::string text_of(const nlohmann::json& json) {
  return json.dump();
}

std::string text_of(const nlohmann::ordered_json& json) {
  return json.dump();
}

}  // namespace biteline::test
