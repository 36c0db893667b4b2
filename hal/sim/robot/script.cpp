// SPDX-License-Identifier: MIT
#include "hal/sim/robot/script.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "hal/sim/robot/script_rows.hpp"

namespace biteline::sim {

Result<Script> parse_script(std::string_view text) {
  Script script;
  Literals variables;
  int line = 0;
  bool inside = false, ended = false;
  std::optional<CodeReader> thread;            // whose body is being read
  std::map<std::string, std::string> running;  // threads by the variable of their handle
  while (!text.empty()) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    std::string_view row = text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
    ++line;
    row = bare_row(row);
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
      script.secondary = name == "sec";
      script.name = reader.word();
      if (!reader.take('(') || !reader.take(')') || !reader.take(':')) return reader.wrong("'():'");
      inside = true;
      continue;
    }
    if (name == "thread") {
      thread.emplace(reader.word(), CodeReader::Part::Thread);
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
        const auto known = std::ranges::find(script.threads, started, &ScriptCode::name);
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
