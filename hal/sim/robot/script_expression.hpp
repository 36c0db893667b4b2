// SPDX-License-Identifier: MIT
#pragma once
/// \file Values and expressions of URScript: read, and worked out.

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"

namespace biteline::sim {

inline constexpr double k_script_mm_per_m = 1000;

/// As the script language has it: m, and a rotation vector in rad.
using ScriptPose = std::array<double, 6>;
[[nodiscard]] SE3 to_se3(const ScriptPose& pose);
[[nodiscard]] ScriptPose to_script_pose(const SE3& T);

/// A number (True is 1), or a pose; a list of six numbers is kept as one.
using ScriptValue = std::variant<double, ScriptPose>;
using ScriptVariables = std::map<std::string, ScriptValue, std::less<>>;

/// What a program sees and sets.
struct ScriptWorld {
  std::function<int(int number)> input_register;
  std::function<SE3(bool actual)> T_base_tcp;  ///< the target, or what the encoders tell
  double step_s{0.002};                        ///< of the controller's cycle
  std::function<void(int number, bool on)> set_output;
  std::function<void(int number, double ratio)> set_analog;
  /// On the tool at its tip, in base axes: N and Nm, as the controller's sensor tells; none: zero.
  std::function<ScriptPose()> tcp_force{};
  std::function<bool(int number)> digital_in{};   ///< standard inputs; none: all off
  std::function<double(int number)> analog_in{};  ///< V; none: 0
  /// What a thread asks of force control and output registers; false: it cannot be done; none: nothing is.
  std::function<bool(std::string_view function, std::span<const ScriptValue> arguments)> act{};
};

struct Expression {
  enum class Kind { Literal, Variable, Operator, Call };
  Kind kind{Kind::Literal};
  ScriptValue value{0.0};  ///< Literal
  std::string word{};      ///< the others: a variable's name, an operator, a function's name
  std::vector<Expression> arguments{};
};

/// Nothing: a pose where a number is needed or the other way round, or no such variable.
[[nodiscard]] std::optional<ScriptValue> value_of(const Expression& expression, const ScriptVariables& locals,
                                                  const ScriptVariables& globals, const ScriptWorld& world);

/// Reads one row from its beginning.  or, and, not; == != < > <= >=; + - * /; brackets; p[...]; lists of six
/// numbers, and a variable's number by its place; the functions read_input_integer_register,
/// get_target_tcp_pose, get_actual_tcp_pose, get_tcp_force, get_steptime, pose_trans, pose_inv, point_dist,
/// sqrt, get_standard_digital_in, get_standard_analog_in.
class RowReader {
 public:
  RowReader(std::string_view text, int line) : text_{text}, line_{line} {}

  [[nodiscard]] bool at_end();
  /// What is not read yet.
  [[nodiscard]] std::string_view rest() const { return text_; }
  [[nodiscard]] std::string word();
  [[nodiscard]] bool take(std::string_view expected);
  [[nodiscard]] Result<Expression> expression();
  [[nodiscard]] Result<double> number();
  [[nodiscard]] tl::unexpected<Error> wrong(const char* expected) const;
  [[nodiscard]] tl::unexpected<Error> unknown(const std::string& name) const;

 private:
  [[nodiscard]] bool take_word(std::string_view expected);
  [[nodiscard]] Result<Expression> level(std::size_t index);
  [[nodiscard]] Result<Expression> single();
  [[nodiscard]] Result<Expression> call(const std::string& name, std::string_view closing);
  [[nodiscard]] Result<Expression> list(const std::string& name, std::size_t count, std::string_view closing);
  void skip();

  std::string_view text_;
  int line_;
  int depth_{0};
};

}  // namespace biteline::sim
