// SPDX-License-Identifier: MIT
#include "hal/sim/robot/script_expression.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <span>

namespace biteline::sim {
namespace {

/// Brackets within brackets; deeper ones are nobody's program.
constexpr int k_deepest = 50;

/// From the loosest to the tightest; where one word begins another, the longer first.
constexpr std::array<std::array<std::string_view, 6>, 5> k_levels{{
    {"or"},
    {"and"},
    {"==", "!=", "<=", ">=", "<", ">"},
    {"+", "-"},
    {"*", "/"},
}};

struct Function {
  std::string_view name;
  std::size_t arguments;
};
constexpr std::array k_functions{Function{"p", 6},
                                 Function{"read_input_integer_register", 1},
                                 Function{"get_target_tcp_pose", 0},
                                 Function{"get_actual_tcp_pose", 0},
                                 Function{"get_steptime", 0},
                                 Function{"pose_trans", 2},
                                 Function{"pose_inv", 1},
                                 Function{"point_dist", 2},
                                 Function{"get_tcp_force", 0},
                                 Function{"get_standard_digital_in", 1},
                                 Function{"get_standard_analog_in", 1},
                                 Function{"sqrt", 1}};
/// No program can name these: a list of six, and the number at a place of one.
constexpr const char *k_list = "[", *k_at = "[]";

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

double worked_out(std::string_view op, double a, double b) {
  if (op == "+") return a + b;
  if (op == "-") return a - b;
  if (op == "*") return a * b;
  if (op == "/") return a / b;
  const bool holds = op == "or"    ? a != 0 || b != 0
                     : op == "and" ? a != 0 && b != 0
                     : op == "=="  ? a == b
                     : op == "!="  ? a != b
                     : op == "<="  ? a <= b
                     : op == ">="  ? a >= b
                     : op == "<"   ? a < b
                                   : a > b;
  return holds ? 1 : 0;
}

using Values = std::span<const ScriptValue>;

std::optional<ScriptValue> of_numbers(std::string_view name, const std::vector<double>& n,
                                      const ScriptWorld& world) {
  if (name == "get_steptime") return world.step_s;
  if (name == "get_target_tcp_pose") return to_script_pose(world.T_base_tcp(false));
  if (name == "get_actual_tcp_pose") return to_script_pose(world.T_base_tcp(true));
  if (name == "read_input_integer_register")
    return static_cast<double>(world.input_register(static_cast<int>(n[0])));
  if (name == "sqrt") return n[0] < 0 ? std::nullopt : std::optional<ScriptValue>{std::sqrt(n[0])};
  if (name == "get_tcp_force") return world.tcp_force ? world.tcp_force() : ScriptPose{};
  if (name == "get_standard_digital_in")
    return world.digital_in && world.digital_in(static_cast<int>(n[0])) ? 1.0 : 0.0;
  if (name == "get_standard_analog_in")
    return world.analog_in ? world.analog_in(static_cast<int>(n[0])) : 0.0;
  if (name == "p" || name == k_list) return ScriptPose{n[0], n[1], n[2], n[3], n[4], n[5]};
  return std::nullopt;
}

std::optional<ScriptValue> of_poses(std::string_view name, const std::vector<ScriptPose>& p) {
  const SE3 T = to_se3(p[0]);
  if (name == "pose_inv") return to_script_pose(T.inverse(Eigen::Isometry));
  if (name == "pose_trans") return to_script_pose(T * to_se3(p[1]));
  if (name == "point_dist") return (T.translation() - to_se3(p[1]).translation()).norm() / k_script_mm_per_m;
  return std::nullopt;
}

/// The number at a place of a list or pose.
std::optional<ScriptValue> at_place(const ScriptValue& list, const ScriptValue& place) {
  const auto* numbers = std::get_if<ScriptPose>(&list);
  const auto* index = std::get_if<double>(&place);
  if (numbers == nullptr || index == nullptr || !(*index >= 0 && *index < 6)) return std::nullopt;
  return (*numbers)[static_cast<std::size_t>(*index)];
}

std::optional<ScriptValue> called(std::string_view name, Values values, const ScriptWorld& world) {
  if (name == k_at) return at_place(values[0], values[1]);
  std::vector<double> numbers;
  std::vector<ScriptPose> poses;
  for (const ScriptValue& value : values) {
    if (const auto* number = std::get_if<double>(&value)) {
      numbers.push_back(*number);
    } else {
      poses.push_back(std::get<ScriptPose>(value));
    }
  }
  if (numbers.size() == values.size()) return of_numbers(name, numbers, world);
  return poses.size() == values.size() ? of_poses(name, poses) : std::nullopt;
}

std::optional<ScriptValue> operated(std::string_view op, Values values) {
  std::vector<double> n;
  for (const ScriptValue& value : values) {
    const auto* number = std::get_if<double>(&value);
    if (number == nullptr) return std::nullopt;
    n.push_back(*number);
  }
  if (n.size() == 1) return op == "not" ? (n[0] == 0 ? 1.0 : 0.0) : -n[0];
  return worked_out(op, n[0], n[1]);
}

}  // namespace

SE3 to_se3(const ScriptPose& pose) {
  SE3 T = SE3::Identity();
  T.translation() = k_script_mm_per_m * Vec3(pose[0], pose[1], pose[2]);
  T.linear() = geometry::exp_so3(Vec3(pose[3], pose[4], pose[5]));
  return T;
}

ScriptPose to_script_pose(const SE3& T) {
  const Vec3 p = T.translation() / k_script_mm_per_m, r = geometry::log_so3(T.linear());
  return {p.x(), p.y(), p.z(), r.x(), r.y(), r.z()};
}

std::optional<ScriptValue> value_of(const Expression& expression, const ScriptVariables& locals,
                                    const ScriptVariables& globals, const ScriptWorld& world) {
  using Kind = Expression::Kind;
  if (expression.kind == Kind::Literal) return expression.value;
  if (expression.kind == Kind::Variable) {
    for (const ScriptVariables* known : {&locals, &globals}) {
      if (const auto found = known->find(expression.word); found != known->end()) return found->second;
    }
    return std::nullopt;
  }
  std::vector<ScriptValue> values;
  for (const Expression& argument : expression.arguments) {
    const std::optional<ScriptValue> value = value_of(argument, locals, globals, world);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return expression.kind == Kind::Operator ? operated(expression.word, values)
                                           : called(expression.word, values, world);
}

void RowReader::skip() {
  while (!text_.empty() && (text_.front() == ' ' || text_.front() == '\t')) text_.remove_prefix(1);
}

bool RowReader::at_end() {
  skip();
  return text_.empty();
}

std::string RowReader::word() {
  skip();
  const auto end = std::ranges::find_if_not(text_, is_word);
  std::string found(text_.begin(), end);
  text_.remove_prefix(found.size());
  return found;
}

bool RowReader::take(std::string_view expected) {
  skip();
  if (!text_.starts_with(expected)) return false;
  text_.remove_prefix(expected.size());
  return true;
}

bool RowReader::take_word(std::string_view expected) {
  skip();
  const bool whole = text_.size() <= expected.size() || !is_word(text_[expected.size()]);
  return whole && take(expected);
}

tl::unexpected<Error> RowReader::wrong(const char* expected) const {
  return fail(Errc::BadFormat, "script line %d: %s expected at '%.*s'", line_, expected,
              static_cast<int>(std::min<std::size_t>(text_.size(), 30)), text_.data());
}

tl::unexpected<Error> RowReader::unknown(const std::string& name) const {
  return fail(Errc::NotSupported, "script line %d: '%s' is not simulated here", line_, name.c_str());
}

Result<double> RowReader::number() {
  skip();
  const std::string copy(text_.substr(0, 64));
  char* end = nullptr;
  const double value = std::strtod(copy.c_str(), &end);
  if (end == copy.c_str() || !(std::abs(value) <= 1e9)) return wrong("a number");
  text_.remove_prefix(static_cast<std::size_t>(end - copy.c_str()));
  return value;
}

Result<Expression> RowReader::expression() {
  if (++depth_ > k_deepest) return wrong("fewer brackets");
  Result<Expression> found = level(0);
  --depth_;
  return found;
}

Result<Expression> RowReader::level(std::size_t index) {
  if (index == k_levels.size()) return single();
  BITELINE_ASSIGN(Expression left, level(index + 1));
  while (true) {
    const auto op = std::ranges::find_if(k_levels[index], [&](std::string_view one) {
      if (one.empty()) return false;
      return is_word(one.front()) ? take_word(one) : take(one);
    });
    if (op == k_levels[index].end()) return left;
    BITELINE_ASSIGN(Expression right, level(index + 1));
    left = {.kind = Expression::Kind::Operator,
            .word = std::string{*op},
            .arguments = {std::move(left), std::move(right)}};
  }
}

Result<Expression> RowReader::single() {
  skip();
  if (text_.empty()) return wrong("a value");
  if (take("(")) {
    BITELINE_ASSIGN(Expression inside, expression());
    if (!take(")")) return wrong("')'");
    return inside;
  }
  const bool minus = take("-");
  if (minus || take_word("not")) {
    if (++depth_ > k_deepest) return wrong("fewer signs");
    BITELINE_ASSIGN(Expression of, minus ? single() : level(2));
    --depth_;
    return Expression{
        .kind = Expression::Kind::Operator, .word = minus ? "-" : "not", .arguments = {std::move(of)}};
  }
  if (take("[")) return list(k_list, 6, "]");
  if (std::isalpha(static_cast<unsigned char>(text_.front())) == 0 && text_.front() != '_') {
    BITELINE_ASSIGN(const double value, number());
    return Expression{.value = value};
  }
  const std::string name = word();
  if (name == "True" || name == "False") return Expression{.value = name == "True" ? 1.0 : 0.0};
  if (take("(")) return call(name, ")");
  if (name == "p" && take("[")) return call(name, "]");
  Expression variable{.kind = Expression::Kind::Variable, .word = name};
  if (!take("[")) return variable;
  BITELINE_ASSIGN(Expression place, expression());
  if (!take("]")) return wrong("']'");
  return Expression{
      .kind = Expression::Kind::Call, .word = k_at, .arguments = {std::move(variable), std::move(place)}};
}

Result<Expression> RowReader::call(const std::string& name, std::string_view closing) {
  const auto* known = std::ranges::find(k_functions, std::string_view{name}, &Function::name);
  if (known == k_functions.end()) return unknown(name);
  return list(name, known->arguments, closing);
}

Result<Expression> RowReader::list(const std::string& name, std::size_t count, std::string_view closing) {
  Expression found{.kind = Expression::Kind::Call, .word = name};
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0 && !take(",")) return wrong("','");
    BITELINE_ASSIGN(Expression argument, expression());
    found.arguments.push_back(std::move(argument));
  }
  if (!take(closing)) return wrong(closing == ")" ? "')'" : "']'");
  return found;
}

}  // namespace biteline::sim
