// SPDX-License-Identifier: MIT
#pragma once
/// \file Tables of text: comma-separated rows, comments after '#'.  Faults name file, row and field.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

#include "common/core/numbers.hpp"
#include "common/core/result.hpp"

namespace biteline::csv {

/// One row's fields, borrowed from the file's text.
class Row {
 public:
  Row(const std::string& file, int number, std::vector<std::string_view> fields)
      : file_{file}, number_{number}, fields_{std::move(fields)} {}

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] std::size_t size() const { return fields_.size(); }
  [[nodiscard]] std::string_view text(std::size_t field) const { return fields_[field]; }

  /// A finite number in `range`; fails naming row and field.  By default a length in mm, which bounds ratios,
  /// too.
  [[nodiscard]] Result<double> number(std::size_t field, NumberRange range = k_plausible_mm) const;
  [[nodiscard]] Result<std::int64_t> integer(std::size_t field) const;

 private:
  const std::string& file_;
  int number_;
  std::vector<std::string_view> fields_;
};

/// Calls `take` for each row that is neither empty nor a comment; each must have between `minimum_fields` and
/// `maximum_fields` fields.  The first fault ends up in the Error, the number of further faulty rows beside
/// it.
[[nodiscard]] Result<void> read_table(const std::filesystem::path& file, std::size_t minimum_fields,
                                      std::size_t maximum_fields,
                                      const std::function<Result<void>(const Row&)>& take);

}  // namespace biteline::csv
