// SPDX-License-Identifier: MIT
#include "common/options/check.hpp"

#include <CLI/CLI.hpp>
#include <sstream>
#include <utility>

namespace biteline::options {

Check::Check(CLI::Validator rule) : rule_{std::make_shared<const CLI::Validator>(std::move(rule))} {}

Check Check::unshown() const {
  CLI::Validator rule = *rule_;
  rule.description("");
  return Check{std::move(rule)};
}

Check operator|(const Check& one, const Check& other) {
  return Check{*one.rule_ | *other.rule_};
}

// CLI11's own Range lets NaN pass, since NaN is neither below nor above anything.
Check number(NumberRange range, const std::string& unit) {
  std::ostringstream words;
  words << "from " << range.minimum << " to " << range.maximum << (unit.empty() ? "" : " ") << unit;
  return Check{CLI::Validator{[range, expected = words.str()](std::string& text) -> std::string {
                                double value = 0;
                                if (CLI::detail::lexical_cast(text, value) && range.holds(value)) return {};
                                return "a finite number " + expected + " expected, found " + text;
                              },
                              words.str()}};
}

Check whole_number(std::int64_t minimum, std::int64_t maximum) {
  return Check{CLI::Range(minimum, maximum)};
}

Check one_of(const std::vector<std::string>& words) {
  return Check{CLI::IsMember(words)};
}

Check one_of_numbers(const std::vector<double>& numbers) {
  return Check{CLI::IsMember(numbers)};
}

Check existing_file() {
  return Check{CLI::ExistingFile};
}

}  // namespace biteline::options
