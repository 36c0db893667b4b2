// SPDX-License-Identifier: MIT
#pragma once
/// \file One row of a program, read: its words, its literals, and the step that a call is.

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/core/result.hpp"
#include "hal/sim/robot/script.hpp"

namespace biteline::sim {

struct PoseLiteral {
  ScriptPose numbers;
};
using ListLiteral = std::array<double, 6>;
using TripleLiteral = std::array<double, 3>;
using Literal = std::variant<double, bool, std::string, PoseLiteral, ListLiteral, TripleLiteral>;
using Literals = std::map<std::string, Literal>;

struct Argument {
  std::string name;  ///< empty: by position
  Literal value;
};

/// Works an expression out at the time when its row is run.  Nothing: it has no value.
using Evaluate = std::function<std::optional<ScriptValue>(const Expression&)>;

/// Reads one row from its beginning.  With `evaluate` an argument may be an expression, else it is a literal
/// or a variable of `variables`.
class LineReader {
 public:
  LineReader(std::string_view text, int line, const Literals& variables, const Evaluate* evaluate = nullptr)
      : text_(text), line_(line), variables_(variables), evaluate_(evaluate) {}

  [[nodiscard]] bool take(char expected);
  [[nodiscard]] std::string word();
  [[nodiscard]] bool take_word(std::string_view expected);
  [[nodiscard]] bool at_end();
  [[nodiscard]] tl::unexpected<Error> wrong(const char* expected) const;
  [[nodiscard]] Result<Literal> literal();
  /// After the opening bracket, up to the closing one.
  [[nodiscard]] Result<std::vector<Argument>> arguments();

 private:
  void skip_spaces();
  [[nodiscard]] Result<double> number();
  [[nodiscard]] Result<Literal> numbers();
  [[nodiscard]] Result<Literal> worked_out();

  std::string_view text_;
  int line_;
  const Literals& variables_;
  const Evaluate* evaluate_;
};

/// Nothing: no thread and no expression takes such a value.
[[nodiscard]] std::optional<ScriptValue> value_for_threads(const Literal& literal);

/// A function of that name is a step, or has no effect here.
[[nodiscard]] bool is_step_function(std::string_view name);

/// Nothing: a call without effect here.
[[nodiscard]] Result<std::optional<ScriptStep>> step_of(const std::string& function,
                                                        const std::vector<Argument>& arguments, int line);

/// Without comment, and without blanks at its end.
[[nodiscard]] std::string_view bare_row(std::string_view row);

}  // namespace biteline::sim
