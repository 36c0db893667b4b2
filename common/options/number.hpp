// SPDX-License-Identifier: MIT
#pragma once
/// \file The command line's border for numbers: every option that takes one says its range and unit.

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

#include "common/core/numbers.hpp"

namespace biteline::options {

/// `app.add_option("--table-z", z_mm)->check(options::number(k_plausible_mm, "mm"));`
/// CLI11's own Range lets NaN pass, since NaN is neither below nor above anything.
inline CLI::Validator number(NumberRange range, const std::string& unit) {
  std::ostringstream words;
  words << "from " << range.minimum << " to " << range.maximum << (unit.empty() ? "" : " ") << unit;
  return CLI::Validator{[range, expected = words.str()](std::string& text) -> std::string {
                          double value = 0;
                          if (CLI::detail::lexical_cast(text, value) && range.holds(value)) return {};
                          return "a finite number " + expected + " expected, found " + text;
                        },
                        words.str()};
}

}  // namespace biteline::options
