// SPDX-License-Identifier: MIT
#pragma once
/// \file JSON read and written by code that is compiled once: its parser and its printer cost each unit that
/// calls them a second of compilation.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace biteline::test {

/// Discarded where the text is no JSON: whatever is asked of it then throws.
[[nodiscard]] nlohmann::json read_json(std::string_view text);
[[nodiscard]] nlohmann::json read_json(std::istream& stream);
[[nodiscard]] nlohmann::json read_json_file(const std::filesystem::path& file);
[[nodiscard]] nlohmann::ordered_json read_ordered_json(std::istream& stream);

[[nodiscard]] std::string text_of(const nlohmann::json& json);
[[nodiscard]] std::string text_of(const nlohmann::ordered_json& json);

}  // namespace biteline::test
