// SPDX-License-Identifier: MIT
#pragma once
/// \file What the value of an option must be: the command line's border.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/core/numbers.hpp"

namespace CLI {
class Validator;
}

namespace biteline::options {

class Check {
 public:
  explicit Check(CLI::Validator rule);
  /// --help does not tell it: the option's type name does.
  [[nodiscard]] Check unshown() const;
  /// One of both is enough.
  friend Check operator|(const Check& one, const Check& other);
  [[nodiscard]] const CLI::Validator& rule() const { return *rule_; }

 private:
  std::shared_ptr<const CLI::Validator> rule_;
};

/// `app.add_option("--table-z", z_mm)->check(options::number(k_plausible_mm, "mm"));`
/// Every option that takes a number says its range and unit; NaN is in none.
[[nodiscard]] Check number(NumberRange range, const std::string& unit);
[[nodiscard]] Check whole_number(std::int64_t minimum, std::int64_t maximum);
[[nodiscard]] Check one_of(const std::vector<std::string>& words);
[[nodiscard]] Check one_of_numbers(const std::vector<double>& numbers);
[[nodiscard]] Check existing_file();

/// One of the names of a table.
template <typename Named>
[[nodiscard]] Check one_of(const std::map<std::string, Named>& table) {
  std::vector<std::string> names;
  for (const auto& [name, named] : table) names.push_back(name);
  return one_of(names);
}

}  // namespace biteline::options
