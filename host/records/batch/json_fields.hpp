// SPDX-License-Identifier: MIT
#pragma once
/// \file Fields of the JSON files of a batch: each is there and of its kind, or the file is refused.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/core/result.hpp"

namespace biteline::batch {

/// One object of a file, which errors name.  Borrows both.
class JsonFields {
 public:
  JsonFields(const nlohmann::ordered_json& json, const std::filesystem::path& file)
      : json_{json}, file_{file} {}

  [[nodiscard]] Result<std::string> text(const char* key) const;
  /// Finite; absent or null is an error.
  [[nodiscard]] Result<double> number(const char* key) const;
  /// Absent or null: none.
  [[nodiscard]] Result<std::optional<double>> number_if(const char* key) const;
  [[nodiscard]] Result<const nlohmann::ordered_json*> array(const char* key) const;
  [[nodiscard]] Result<const nlohmann::ordered_json*> object(const char* key) const;

 private:
  [[nodiscard]] const nlohmann::ordered_json* find(const char* key) const;
  [[nodiscard]] tl::unexpected<Error> wrong(const char* key, const char* expected) const;

  const nlohmann::ordered_json& json_;
  const std::filesystem::path& file_;
};

/// The whole of a JSON file that is an object.
[[nodiscard]] Result<nlohmann::ordered_json> read_json_object(const std::filesystem::path& file);

/// As report::write_file_atomically(), also while other processes and machines write the same file.
[[nodiscard]] Result<void> write_shared_file(const std::filesystem::path& file, const std::string& text);

}  // namespace biteline::batch
