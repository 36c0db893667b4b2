// SPDX-License-Identifier: MIT
#include "hal/sim/robot/script.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

namespace biteline::sim {

namespace {

/// URScript's defaults: 1.2 m/s^2 and 0.25 m/s for straight moves, 1.4 rad/s^2 and 1.05 rad/s for joint
/// moves.
constexpr double k_linear_acceleration = 1.2, k_linear_speed = 0.25;
constexpr double k_joint_acceleration = 1.4, k_joint_speed = 1.05;

struct Pose {
  ScriptPose numbers;
};
using List = std::array<double, 6>;
using Triple = std::array<double, 3>;
using Literal = std::variant<double, bool, std::string, Pose, List, Triple>;

/// Nothing: a thread takes no such value.
std::optional<ScriptValue> value_for_threads(const Literal& literal) {
  if (const auto* number = std::get_if<double>(&literal)) return *number;
  if (const auto* truth = std::get_if<bool>(&literal)) return *truth ? 1.0 : 0.0;
  if (const auto* pose = std::get_if<Pose>(&literal)) return pose->numbers;
  return std::nullopt;
}

struct Argument {
  std::string name;  ///< empty: by position
  Literal value;
};

/// Reads one line.
class LineReader {
 public:
  LineReader(std::string_view text, int line, const std::map<std::string, Literal>& variables)
      : text_(text), line_(line), variables_(variables) {}

  void skip_spaces() {
    while (!text_.empty() && (text_.front() == ' ' || text_.front() == '\t')) text_.remove_prefix(1);
  }
  bool take(char expected) {
    skip_spaces();
    if (text_.empty() || text_.front() != expected) return false;
    text_.remove_prefix(1);
    return true;
  }
  std::string word() {
    skip_spaces();
    std::size_t length = 0;
    while (length < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[length])) != 0 || text_[length] == '_'))
      ++length;
    std::string found(text_.substr(0, length));
    text_.remove_prefix(length);
    return found;
  }
  bool take_word(std::string_view expected) {
    const std::string_view before = text_;
    if (word() == expected) return true;
    text_ = before;
    return false;
  }
  [[nodiscard]] bool at_end() {
    skip_spaces();
    return text_.empty();
  }
  [[nodiscard]] tl::unexpected<Error> wrong(const char* expected) const {
    return fail(Errc::BadFormat, "script line %d: %s expected at '%.*s'", line_, expected,
                static_cast<int>(std::min<std::size_t>(text_.size(), 30)), text_.data());
  }
  [[nodiscard]] int line() const { return line_; }

  Result<double> number() {
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
  Result<Literal> numbers() {
    List list{};
    std::size_t count = 0;
    do {
      if (count == list.size()) return wrong("at most six numbers");
      BITELINE_ASSIGN(list[count], number());
      ++count;
    } while (take(','));
    if (!take(']')) return wrong("']'");
    if (count == list.size()) return Literal{list};
    if (count == 3) return Literal{Triple{list[0], list[1], list[2]}};
    return wrong("three or six numbers");
  }
  Result<List> six_numbers() {
    BITELINE_ASSIGN(const Literal found, numbers());
    if (const auto* list = std::get_if<List>(&found)) return *list;
    return wrong("six numbers");
  }

  Result<Literal> literal() {
    skip_spaces();
    if (take('[')) return numbers();
    if (take('"')) {
      const std::size_t end = text_.find('"');
      if (end == std::string_view::npos) return wrong("a closing quote");
      std::string found(text_.substr(0, end));
      text_.remove_prefix(end + 1);
      return Literal{std::move(found)};
    }
    if (!text_.empty() && std::isalpha(static_cast<unsigned char>(text_.front())) != 0) {
      const std::string name = word();
      if (name == "p" && take('[')) {
        BITELINE_ASSIGN(const List list, six_numbers());
        return Literal{Pose{list}};
      }
      if (name == "True" || name == "False") return Literal{name == "True"};
      const auto variable = variables_.find(name);
      if (variable != variables_.end()) return variable->second;
      return fail(Errc::NotSupported, "script line %d: '%s' is not known here", line_, name.c_str());
    }
    BITELINE_ASSIGN(const double value, number());
    return Literal{value};
  }

  /// After the opening bracket, up to the closing one.
  Result<std::vector<Argument>> arguments() {
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

 private:
  std::string_view text_;
  int line_;
  const std::map<std::string, Literal>& variables_;
};

/// The number named `name`, or at `position` without name.
Result<double> number_of(const std::vector<Argument>& arguments, const char* name, std::size_t position,
                         double fallback, int line) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i].name != name && !(arguments[i].name.empty() && i == position)) continue;
    if (const auto* number = std::get_if<double>(&arguments[i].value)) return *number;
    return fail(Errc::BadValue, "script line %d: %s: a number expected", line, name);
  }
  return fallback;
}

Result<ScriptStep> move_step(const std::string& function, const std::vector<Argument>& arguments, int line) {
  MoveStep move;
  const bool joint = function == "movej";
  move.kind = joint                 ? MoveStep::Kind::Joint
              : function == "movep" ? MoveStep::Kind::Process
                                    : MoveStep::Kind::Linear;
  if (arguments.empty())
    return fail(Errc::BadFormat, "script line %d: %s needs a goal", line, function.c_str());
  if (const auto* pose = std::get_if<Pose>(&arguments[0].value)) {
    move.T_base_tcp = to_se3(pose->numbers);
  } else if (const auto* joints = std::get_if<List>(&arguments[0].value)) {
    move.q_rad = Eigen::Map<const JointVector>(joints->data());
  } else {
    return fail(Errc::BadValue, "script line %d: %s: a pose or six joints expected", line, function.c_str());
  }
  const double unit = joint ? 1 : k_script_mm_per_m;
  BITELINE_ASSIGN(const double acceleration,
                  number_of(arguments, "a", 1, joint ? k_joint_acceleration : k_linear_acceleration, line));
  BITELINE_ASSIGN(const double speed,
                  number_of(arguments, "v", 2, joint ? k_joint_speed : k_linear_speed, line));
  // movep has no time argument: its radius comes a place earlier.
  BITELINE_ASSIGN(const double time_s, number_of(arguments, "t", function == "movep" ? 99 : 3, 0, line));
  BITELINE_ASSIGN(const double blend, number_of(arguments, "r", function == "movep" ? 3 : 4, 0, line));
  if (time_s != 0) return fail(Errc::NotSupported, "script line %d: a move by time is not simulated", line);
  if (speed <= 0 || acceleration <= 0 || blend < 0) {
    return fail(Errc::BadValue, "script line %d: a > 0, v > 0 and r >= 0 expected", line);
  }
  move.speed = unit * speed;
  move.acceleration = unit * acceleration;
  move.blend_mm = k_script_mm_per_m * blend;
  return ScriptStep{move};
}

/// Nothing: a call without effect here.
Result<std::optional<ScriptStep>> step_of(const std::string& function, const std::vector<Argument>& arguments,
                                          int line) {
  if (function == "movel" || function == "movep" || function == "movej") {
    BITELINE_ASSIGN(ScriptStep step, move_step(function, arguments, line));
    return std::optional{std::move(step)};
  }
  if (function == "set_tcp") {
    const auto* pose = arguments.empty() ? nullptr : std::get_if<Pose>(&arguments[0].value);
    if (pose == nullptr) return fail(Errc::BadValue, "script line %d: set_tcp: a pose expected", line);
    return std::optional<ScriptStep>{SetTcpStep{to_se3(pose->numbers)}};
  }
  if (function == "set_payload") {
    BITELINE_ASSIGN(const double mass_kg, number_of(arguments, "m", 0, -1, line));
    const auto* centre = arguments.size() > 1 ? std::get_if<Triple>(&arguments[1].value) : nullptr;
    if (mass_kg < 0 || (arguments.size() > 1 && centre == nullptr)) {
      return fail(Errc::BadValue,
                  "script line %d: set_payload: a mass in kg and a centre [x,y,z] in m expected", line);
    }
    Payload payload{.mass_kg = mass_kg};
    if (centre != nullptr)
      payload.centre_mm = k_script_mm_per_m * Vec3((*centre)[0], (*centre)[1], (*centre)[2]);
    return std::optional<ScriptStep>{payload};
  }
  if (function == "sleep") {
    BITELINE_ASSIGN(const double time_s, number_of(arguments, "t", 0, 0, line));
    return std::optional<ScriptStep>{SleepStep{std::max(0.0, time_s)}};
  }
  if (function == "set_digital_out" || function == "set_standard_digital_out") {
    const auto* number = arguments.size() == 2 ? std::get_if<double>(&arguments[0].value) : nullptr;
    const auto* active = arguments.size() == 2 ? std::get_if<bool>(&arguments[1].value) : nullptr;
    if (number == nullptr || active == nullptr || *number < 0 || *number > 7) {
      return fail(Errc::BadValue, "script line %d: %s: an output 0 to 7 and True or False expected", line,
                  function.c_str());
    }
    return std::optional<ScriptStep>{DigitalOutStep{static_cast<int>(*number), *active}};
  }
  if (function == "set_standard_analog_out") {
    BITELINE_ASSIGN(const double number, number_of(arguments, "n", 0, -1, line));
    BITELINE_ASSIGN(const double ratio, number_of(arguments, "f", 1, -1, line));
    if (!(number == 0 || number == 1) || !(ratio >= 0 && ratio <= 1))
      return fail(Errc::BadValue, "script line %d: %s: an output 0 or 1 and a share from 0 to 1 expected",
                  line, function.c_str());
    return std::optional<ScriptStep>{AnalogOutStep{static_cast<int>(number), ratio}};
  }
  if (function == "textmsg") {
    const auto* text = arguments.empty() ? nullptr : std::get_if<std::string>(&arguments[0].value);
    return std::optional<ScriptStep>{TextStep{text != nullptr ? *text : ""}};
  }
  if (function == "rtde_set_watchdog") {
    const auto* variable = arguments.empty() ? nullptr : std::get_if<std::string>(&arguments[0].value);
    const auto* action = arguments.size() < 3 ? nullptr : std::get_if<std::string>(&arguments[2].value);
    BITELINE_ASSIGN(const double min_hz, number_of(arguments, "min_frequency", 1, 0, line));
    if (variable == nullptr || !(min_hz > 0))
      return fail(Errc::BadValue, "script line %d: %s: a variable and a frequency expected", line,
                  function.c_str());
    if (action == nullptr || (*action != "stop" && *action != "ignore"))
      return fail(Errc::NotSupported, "script line %d: %s: no action but stop and ignore is simulated", line,
                  function.c_str());
    return std::optional<ScriptStep>{
        WatchdogStep{.variable = *variable, .min_hz = min_hz, .stops = *action == "stop"}};
  }
  if (function == "sync" || function == "stopl" || function == "stopj") return std::optional<ScriptStep>{};
  return fail(Errc::NotSupported, "script line %d: '%s' is not simulated", line, function.c_str());
}

}  // namespace

Result<Script> parse_script(std::string_view text) {
  Script script;
  std::map<std::string, Literal> variables;
  int line = 0;
  bool inside = false, ended = false;
  std::optional<ThreadReader> thread;          // whose body is being read
  std::map<std::string, std::string> running;  // threads by the variable of their handle
  while (!text.empty()) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    std::string_view row = text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
    ++line;
    row = row.substr(0, row.find('#'));
    while (!row.empty() && (row.back() == '\r' || row.back() == ' ' || row.back() == '\t'))
      row.remove_suffix(1);
    LineReader reader(row, line, variables);
    if (reader.at_end()) continue;
    if (thread) {
      BITELINE_ASSIGN(const bool whole, thread->take(row, line));
      if (whole) script.threads.push_back((*std::exchange(thread, std::nullopt)).code());
      continue;
    }
    if (ended) return fail(Errc::BadFormat, "script line %d: something follows the end of the program", line);
    std::string name = reader.word();
    if (name == "def" || name == "sec") {
      if (inside)
        return fail(Errc::NotSupported, "script line %d: a function inside the program is not simulated",
                    line);
      script.name = reader.word();
      if (!reader.take('(') || !reader.take(')') || !reader.take(':')) return reader.wrong("'():'");
      inside = true;
      continue;
    }
    if (name == "thread") {
      thread.emplace(reader.word());
      if (!reader.take('(') || !reader.take(')') || !reader.take(':')) return reader.wrong("'():'");
      continue;
    }
    if (name == "kill") {
      const auto known = running.find(reader.word());
      if (known == running.end()) return reader.wrong("kill and a thread that runs");
      script.steps.emplace_back(KillThreadStep{known->second});
      continue;
    }
    if (name == "end") {
      if (!inside) return fail(Errc::BadFormat, "script line %d: 'end' without 'def'", line);
      ended = true;
      continue;
    }
    if (name == "local" || name == "global") name = reader.word();
    if (reader.take('=')) {
      if (reader.take_word("run")) {
        const std::string started = reader.word();
        const auto known = std::ranges::find(script.threads, started, &ThreadCode::name);
        if (known == script.threads.end() || !reader.take('(') || !reader.take(')'))
          return reader.wrong("run and a thread's name()");
        running[name] = started;
        script.steps.emplace_back(RunThreadStep{started});
        continue;
      }
      BITELINE_ASSIGN(variables[name], reader.literal());
      if (!reader.at_end()) return reader.wrong("the end of the line");
      if (auto value = value_for_threads(variables[name]))
        script.steps.emplace_back(AssignStep{.name = name, .value = *value});
      continue;
    }
    if (!reader.take('('))
      return fail(Errc::NotSupported, "script line %d: '%s' is not simulated", line, name.c_str());
    BITELINE_ASSIGN(const auto arguments, reader.arguments());
    if (!reader.at_end()) return reader.wrong("the end of the line");
    BITELINE_ASSIGN(auto step, step_of(name, arguments, line));
    if (step) script.steps.push_back(std::move(*step));
  }
  if (thread || (inside && !ended)) return fail(Errc::Truncated, "script line %d: 'end' is missing", line);
  // Nobody else sees a variable, and an assignment stops no arm.
  if (script.threads.empty())
    std::erase_if(script.steps,
                  [](const ScriptStep& step) { return std::holds_alternative<AssignStep>(step); });
  return script;
}

}  // namespace biteline::sim
