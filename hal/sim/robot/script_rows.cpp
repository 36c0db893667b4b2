// SPDX-License-Identifier: MIT
#include "hal/sim/robot/script_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace biteline::sim {
namespace {

/// URScript's defaults: 1.2 m/s^2 and 0.25 m/s for straight moves, 1.4 rad/s^2 and 1.05 rad/s for joint
/// moves.
constexpr double k_linear_acceleration = 1.2, k_linear_speed = 0.25;
constexpr double k_joint_acceleration = 1.4, k_joint_speed = 1.05;

/// A program's outputs by their functions' names: standard ones first, then configurable ones, then the
/// tool's.
constexpr int k_first_configurable = 8, k_first_tool = 16;

struct Call {
  const std::string& function;
  const std::vector<Argument>& arguments;
  int line;

  /// What stands at `position`, or nothing of that kind.
  template <class Kind>
  [[nodiscard]] const Kind* at(std::size_t position) const {
    return position < arguments.size() ? std::get_if<Kind>(&arguments[position].value) : nullptr;
  }
  /// The number named `name`, or at `position` without name.
  [[nodiscard]] Result<double> number(const char* name, std::size_t position, double fallback) const {
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      if (arguments[i].name != name && !(arguments[i].name.empty() && i == position)) continue;
      if (const auto* number = std::get_if<double>(&arguments[i].value)) return *number;
      return fail(Errc::BadValue, "script line %d: %s: a number expected", line, name);
    }
    return fallback;
  }
  [[nodiscard]] tl::unexpected<Error> bad(const char* expected) const {
    return fail(Errc::BadValue, "script line %d: %s: %s expected", line, function.c_str(), expected);
  }
};
using MaybeStep = Result<std::optional<ScriptStep>>;

MaybeStep move_step(const Call& call) {
  MoveStep move;
  const bool joint = call.function == "movej";
  const bool process = call.function == "movep";
  move.kind = joint ? MoveStep::Kind::Joint : process ? MoveStep::Kind::Process : MoveStep::Kind::Linear;
  if (const auto* pose = call.at<PoseLiteral>(0)) {
    move.T_base_tcp = to_se3(pose->numbers);
  } else if (const auto* joints = call.at<ListLiteral>(0)) {
    move.q_rad = Eigen::Map<const JointVector>(joints->data());
  } else {
    return call.bad("a pose or six joints");
  }
  const double unit = joint ? 1 : k_script_mm_per_m;
  BITELINE_ASSIGN(const double acceleration,
                  call.number("a", 1, joint ? k_joint_acceleration : k_linear_acceleration));
  BITELINE_ASSIGN(const double speed, call.number("v", 2, joint ? k_joint_speed : k_linear_speed));
  // movep has no time argument: its radius comes a place earlier.
  BITELINE_ASSIGN(const double time_s, call.number("t", process ? 99 : 3, 0));
  BITELINE_ASSIGN(const double blend, call.number("r", process ? 3 : 4, 0));
  if (time_s != 0)
    return fail(Errc::NotSupported, "script line %d: a move by time is not simulated", call.line);
  if (speed <= 0 || acceleration <= 0 || blend < 0) return call.bad("a > 0, v > 0 and r >= 0");
  move.speed = unit * speed;
  move.acceleration = unit * acceleration;
  move.blend_mm = k_script_mm_per_m * blend;
  return ScriptStep{move};
}

MaybeStep tcp_step(const Call& call) {
  const auto* pose = call.at<PoseLiteral>(0);
  if (pose == nullptr) return call.bad("a pose");
  return ScriptStep{SetTcpStep{to_se3(pose->numbers)}};
}

MaybeStep payload_step(const Call& call) {
  BITELINE_ASSIGN(const double mass_kg, call.number("m", 0, -1));
  const auto* centre = call.at<TripleLiteral>(1);
  if (mass_kg < 0 || (call.arguments.size() > 1 && centre == nullptr))
    return call.bad("a mass in kg and a centre [x,y,z] in m");
  Payload payload{.mass_kg = mass_kg};
  if (centre != nullptr)
    payload.centre_mm = k_script_mm_per_m * Vec3((*centre)[0], (*centre)[1], (*centre)[2]);
  return ScriptStep{payload};
}

MaybeStep sleep_step(const Call& call) {
  BITELINE_ASSIGN(const double time_s, call.number("t", 0, 0));
  return ScriptStep{SleepStep{std::max(0.0, time_s)}};
}

MaybeStep digital_step(const Call& call) {
  const bool tool = call.function == "set_tool_digital_out";
  const int first = tool                                              ? k_first_tool
                    : call.function == "set_configurable_digital_out" ? k_first_configurable
                                                                      : 0;
  const int count = tool ? 2 : 8;
  const auto* number = call.at<double>(0);
  const auto* active = call.at<bool>(1);
  if (call.arguments.size() != 2 || number == nullptr || active == nullptr || *number < 0 || *number >= count)
    return call.bad(tool ? "an output 0 or 1 and True or False" : "an output 0 to 7 and True or False");
  return ScriptStep{DigitalOutStep{first + static_cast<int>(*number), *active}};
}

MaybeStep analog_step(const Call& call) {
  BITELINE_ASSIGN(const double number, call.number("n", 0, -1));
  BITELINE_ASSIGN(const double ratio, call.number("f", 1, -1));
  if (!(number == 0 || number == 1) || !(ratio >= 0 && ratio <= 1))
    return call.bad("an output 0 or 1 and a share from 0 to 1");
  return ScriptStep{AnalogOutStep{static_cast<int>(number), ratio}};
}

std::string text_of(const Call& call) {
  const auto* text = call.at<std::string>(0);
  return text != nullptr ? *text : "";
}

MaybeStep text_step(const Call& call) {
  return ScriptStep{TextStep{text_of(call)}};
}

MaybeStep popup_step(const Call& call) {
  const auto blocks = std::ranges::find(call.arguments, "blocking", &Argument::name);
  const auto* by_name = blocks == call.arguments.end() ? nullptr : std::get_if<bool>(&blocks->value);
  const auto* by_place = call.at<bool>(4);
  return ScriptStep{
      PopupStep{.text = text_of(call),
                .blocking = (by_name != nullptr && *by_name) || (by_place != nullptr && *by_place)}};
}

MaybeStep watchdog_step(const Call& call) {
  const auto* variable = call.at<std::string>(0);
  const auto* action = call.at<std::string>(2);
  BITELINE_ASSIGN(const double min_hz, call.number("min_frequency", 1, 0));
  if (variable == nullptr || !(min_hz > 0)) return call.bad("a variable and a frequency");
  if (action == nullptr || (*action != "stop" && *action != "ignore"))
    return fail(Errc::NotSupported, "script line %d: %s: no action but stop and ignore is simulated",
                call.line, call.function.c_str());
  return ScriptStep{WatchdogStep{.variable = *variable, .min_hz = min_hz, .stops = *action == "stop"}};
}

MaybeStep protective_stop_step(const Call&) {
  return ScriptStep{ProtectiveStopStep{}};
}

MaybeStep no_step(const Call&) {
  return std::optional<ScriptStep>{};
}

struct StepFunction {
  std::string_view name;
  MaybeStep (*step)(const Call& call);
};
constexpr std::array k_step_functions{StepFunction{"movel", move_step},
                                      StepFunction{"movep", move_step},
                                      StepFunction{"movej", move_step},
                                      StepFunction{"set_tcp", tcp_step},
                                      StepFunction{"set_payload", payload_step},
                                      StepFunction{"sleep", sleep_step},
                                      StepFunction{"set_digital_out", digital_step},
                                      StepFunction{"set_standard_digital_out", digital_step},
                                      StepFunction{"set_configurable_digital_out", digital_step},
                                      StepFunction{"set_tool_digital_out", digital_step},
                                      StepFunction{"set_standard_analog_out", analog_step},
                                      StepFunction{"textmsg", text_step},
                                      StepFunction{"popup", popup_step},
                                      StepFunction{"protective_stop", protective_stop_step},
                                      StepFunction{"rtde_set_watchdog", watchdog_step},
                                      StepFunction{"sync", no_step},
                                      StepFunction{"stopl", no_step},
                                      StepFunction{"stopj", no_step}};

}  // namespace

std::string_view bare_row(std::string_view row) {
  row = row.substr(0, row.find('#'));
  while (!row.empty() && (row.back() == '\r' || row.back() == ' ' || row.back() == '\t'))
    row.remove_suffix(1);
  return row;
}

std::optional<ScriptValue> value_for_threads(const Literal& literal) {
  if (const auto* number = std::get_if<double>(&literal)) return *number;
  if (const auto* truth = std::get_if<bool>(&literal)) return *truth ? 1.0 : 0.0;
  if (const auto* pose = std::get_if<PoseLiteral>(&literal)) return pose->numbers;
  return std::nullopt;
}

bool is_step_function(std::string_view name) {
  return std::ranges::find(k_step_functions, name, &StepFunction::name) != k_step_functions.end();
}

Result<std::optional<ScriptStep>> step_of(const std::string& function, const std::vector<Argument>& arguments,
                                          int line) {
  const auto* known = std::ranges::find(k_step_functions, std::string_view{function}, &StepFunction::name);
  if (known == k_step_functions.end())
    return fail(Errc::NotSupported, "script line %d: '%s' is not simulated", line, function.c_str());
  return known->step({.function = function, .arguments = arguments, .line = line});
}

void LineReader::skip_spaces() {
  while (!text_.empty() && (text_.front() == ' ' || text_.front() == '\t')) text_.remove_prefix(1);
}

bool LineReader::take(char expected) {
  skip_spaces();
  if (text_.empty() || text_.front() != expected) return false;
  text_.remove_prefix(1);
  return true;
}

std::string LineReader::word() {
  skip_spaces();
  std::size_t length = 0;
  while (length < text_.size() &&
         (std::isalnum(static_cast<unsigned char>(text_[length])) != 0 || text_[length] == '_'))
    ++length;
  std::string found(text_.substr(0, length));
  text_.remove_prefix(length);
  return found;
}

bool LineReader::take_word(std::string_view expected) {
  const std::string_view before = text_;
  if (word() == expected) return true;
  text_ = before;
  return false;
}

bool LineReader::at_end() {
  skip_spaces();
  return text_.empty();
}

tl::unexpected<Error> LineReader::wrong(const char* expected) const {
  return fail(Errc::BadFormat, "script line %d: %s expected at '%.*s'", line_, expected,
              static_cast<int>(std::min<std::size_t>(text_.size(), 30)), text_.data());
}

Result<double> LineReader::number() {
  skip_spaces();
  const std::string copy(text_.substr(0, 64));
  char* end = nullptr;
  const double value = std::strtod(copy.c_str(), &end);
  if (end == copy.c_str() || !std::isfinite(value)) return wrong("a finite number");
  // Metres, radians, and their rates: no arm's are beyond, and squares stay numbers.
  constexpr double k_most = 1e4;
  if (!(std::abs(value) <= k_most)) return wrong("a number of at most 10 000");
  text_.remove_prefix(static_cast<std::size_t>(end - copy.c_str()));
  return value;
}

/// After the opening bracket, with the closing one: three or six.
Result<Literal> LineReader::numbers() {
  ListLiteral list{};
  std::size_t count = 0;
  do {
    if (count == list.size()) return wrong("at most six numbers");
    BITELINE_ASSIGN(list[count], number());
    ++count;
  } while (take(','));
  if (!take(']')) return wrong("']'");
  if (count == list.size()) return Literal{list};
  if (count == 3) return Literal{TripleLiteral{list[0], list[1], list[2]}};
  return wrong("three or six numbers");
}

/// An expression, by the values that its variables have now.
Result<Literal> LineReader::worked_out() {
  RowReader row{text_, line_};
  BITELINE_ASSIGN(const Expression expression, row.expression());
  const auto before = text_;
  text_ = row.rest();
  const auto value = (*evaluate_)(expression);
  if (!value)
    return fail(Errc::BadValue, "script line %d: no value for '%.*s'", line_,
                static_cast<int>(before.size() - text_.size()), before.data());
  if (const auto* number = std::get_if<double>(&*value)) return Literal{*number};
  return Literal{PoseLiteral{std::get<ScriptPose>(*value)}};
}

Result<Literal> LineReader::literal() {
  skip_spaces();
  if (take('[')) return numbers();
  if (take('"')) {
    const std::size_t end = text_.find('"');
    if (end == std::string_view::npos) return wrong("a closing quote");
    std::string found(text_.substr(0, end));
    text_.remove_prefix(end + 1);
    return Literal{std::move(found)};
  }
  if (take_word("True")) return Literal{true};
  if (take_word("False")) return Literal{false};
  if (evaluate_ != nullptr) return worked_out();
  if (!text_.empty() && std::isalpha(static_cast<unsigned char>(text_.front())) != 0) {
    const std::string name = word();
    if (name == "p" && take('[')) {
      BITELINE_ASSIGN(const Literal found, numbers());
      if (const auto* list = std::get_if<ListLiteral>(&found)) return Literal{PoseLiteral{*list}};
      return wrong("six numbers");
    }
    const auto variable = variables_.find(name);
    if (variable != variables_.end()) return variable->second;
    return fail(Errc::NotSupported, "script line %d: '%s' is not known here", line_, name.c_str());
  }
  BITELINE_ASSIGN(const double value, number());
  return Literal{value};
}

Result<std::vector<Argument>> LineReader::arguments() {
  std::vector<Argument> found;
  if (take(')')) return found;
  do {
    Argument argument;
    const std::string_view before = text_;
    const std::string name = word();
    if (!name.empty() && take('=')) {
      argument.name = name;
    } else {
      text_ = before;
    }
    BITELINE_ASSIGN(argument.value, literal());
    found.push_back(std::move(argument));
  } while (take(','));
  if (!take(')')) return wrong("')'");
  return found;
}

}  // namespace biteline::sim
