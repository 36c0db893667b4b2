// SPDX-License-Identifier: MIT
#pragma once
/// \file A process as JSON, and its JSON Schema: both made from the keys that the process reader asks for.

#include "common/config/yaml_reader.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::api {

/// JSON Schema (2020-12) of process files: ranges and defaults of the reader, units (`x-unit`) of the names,
/// help (`description`) of a table here.
[[nodiscard]] control::Json process_schema();

/// The values as read, nested as in the file; keys that were not there are left out.
[[nodiscard]] control::Json process_json(const config::KeysAsked& keys);

/// "mm", "mm/s", "degrees", ... by the end of a key's name; empty: a plain number or a word.
[[nodiscard]] std::string unit_of(const std::string& key);
/// Help for a key, by its path; empty: none (a test sees to it that each has some).
[[nodiscard]] std::string help_of(const std::string& path);

}  // namespace biteline::api
