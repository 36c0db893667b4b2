// SPDX-License-Identifier: MIT
#pragma once
/// \file What a filter of scans means in SQL.

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "host/records/memory/memory.hpp"

namespace biteline::memory {

/// " WHERE ..." of a filter; its values are bound in the same order.
struct Where {
  std::string sql;
  std::vector<std::variant<std::int64_t, std::string>> values;

  void add(const std::string& condition, std::variant<std::int64_t, std::string> value) {
    sql += (sql.empty() ? " WHERE " : " AND ") + condition;
    values.push_back(std::move(value));
  }
  void bind_to(Statement& statement) const {
    for (const auto& value : values) {
      if (const auto* number = std::get_if<std::int64_t>(&value)) {
        statement.bind(*number);
      } else {
        statement.bind(std::string_view{std::get<std::string>(value)});
      }
    }
  }
};

[[nodiscard]] Where where_of(const ScanFilter& filter);

}  // namespace biteline::memory
