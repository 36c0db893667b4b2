// SPDX-License-Identifier: MIT
#include "hal/sim/robot/script_code.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "hal/sim/robot/script_rows.hpp"

namespace biteline::sim {
namespace {

// What a thread may do without sleep or sync before its frame is over.
constexpr int k_most_in_a_frame = 10'000;

/// What a thread may ask of force control and of output registers, with its number of arguments.
struct ActFunction {
  std::string_view name;
  std::size_t arguments;
};
constexpr std::array k_act_functions{ActFunction{"force_mode", 5},
                                     ActFunction{"end_force_mode", 0},
                                     ActFunction{"force_mode_set_damping", 1},
                                     ActFunction{"force_mode_set_gain_scaling", 1},
                                     ActFunction{"zero_ftsensor", 0},
                                     ActFunction{"write_output_integer_register", 2}};

/// A call that stands alone.
Result<Instruction> call(RowReader& row, const std::string& name) {
  Instruction found;
  if (name == "sync") {
    found.kind = Instruction::Kind::Sync;
  } else if (name == "sleep") {
    found.kind = Instruction::Kind::Sleep;
    BITELINE_ASSIGN(found.value, row.expression());
  } else if (name == "set_digital_out" || name == "set_standard_digital_out") {
    found.kind = Instruction::Kind::Output;
    BITELINE_ASSIGN(const double number, row.number());
    if (!(number >= 0 && number <= 7) || !row.take(","))
      return row.wrong("an output 0 to 7 and True or False");
    found.output = static_cast<int>(number);
    BITELINE_ASSIGN(found.value, row.expression());
  } else if (name == "set_standard_analog_out") {
    found.kind = Instruction::Kind::Analog;
    BITELINE_ASSIGN(const double number, row.number());
    if (!(number == 0 || number == 1) || !row.take(","))
      return row.wrong("an analog output 0 or 1 and a share");
    found.output = static_cast<int>(number);
    BITELINE_ASSIGN(found.value, row.expression());
  } else if (const auto* known =
                 std::ranges::find(k_act_functions, std::string_view{name}, &ActFunction::name);
             known != k_act_functions.end()) {
    found.kind = Instruction::Kind::Act;
    found.name = name;
    for (std::size_t i = 0; i < known->arguments; ++i) {
      if (i > 0 && !row.take(",")) return row.wrong("','");
      BITELINE_ASSIGN(Expression argument, row.expression());
      found.arguments.push_back(std::move(argument));
    }
  } else {
    return row.unknown(name);
  }
  if (!row.take(")")) return row.wrong("')'");
  return found;
}

}  // namespace

Result<void> CodeReader::begin_block(RowReader& row, bool loop, int line) {
  Instruction test{.kind = Instruction::Kind::JumpUnless, .line = line};
  BITELINE_ASSIGN(test.value, row.expression());
  if (!row.take(":") || !row.at_end()) return row.wrong("':'");
  const std::size_t at = code_.instructions.size();
  blocks_.push_back({.test = at, .begin = at, .loop = loop});
  code_.instructions.push_back(std::move(test));
  return {};
}

Result<void> CodeReader::next_part(RowReader& row, bool has_test, int line) {
  if (blocks_.empty() || blocks_.back().loop || !blocks_.back().test) return row.wrong("an 'if' before");
  Block& block = blocks_.back();
  std::vector<Instruction>& all = code_.instructions;
  block.exits.push_back(all.size());
  all.push_back({.kind = Instruction::Kind::Jump, .line = line});
  all[*std::exchange(block.test, std::nullopt)].target = all.size();
  if (has_test) {
    Instruction test{.kind = Instruction::Kind::JumpUnless, .line = line};
    BITELINE_ASSIGN(test.value, row.expression());
    block.test = all.size();
    all.push_back(std::move(test));
  }
  if (!row.take(":") || !row.at_end()) return row.wrong("':'");
  return {};
}

bool CodeReader::end_block() {
  if (blocks_.empty()) return true;
  const Block block = std::move(blocks_.back());
  blocks_.pop_back();
  std::vector<Instruction>& all = code_.instructions;
  if (block.loop) all.push_back({.kind = Instruction::Kind::Jump, .target = block.begin});
  if (block.test) all[*block.test].target = all.size();
  for (const std::size_t exit : block.exits) all[exit].target = all.size();
  return false;
}

Result<void> CodeReader::statement(RowReader& row, std::string name, std::string_view text, int line) {
  const bool local = name == "local";
  if (local || name == "global") name = row.word();
  if (row.take("(")) {
    Instruction instruction{.kind = Instruction::Kind::Row, .name = std::string{text}};
    if (part_ == Part::Thread || name == "sync") {
      BITELINE_ASSIGN(instruction, call(row, name));
      if (!row.at_end()) return row.wrong("the end of the line");
    } else if (!is_step_function(name)) {
      return row.unknown(name);
    }
    instruction.line = line;
    code_.instructions.push_back(std::move(instruction));
    return {};
  }
  if (!row.take("=")) return row.unknown(name);
  Instruction assign{.kind = Instruction::Kind::Assign, .line = line, .name = name, .local = local};
  BITELINE_ASSIGN(assign.value, row.expression());
  if (!row.at_end()) return row.wrong("the end of the line");
  code_.instructions.push_back(std::move(assign));
  return {};
}

Result<bool> CodeReader::take(std::string_view text, int line) {
  RowReader row{text, line};
  std::string name = row.word();
  if (name == "end") return end_block();
  if (name == "while" || name == "if") {
    BITELINE_TRY(begin_block(row, name == "while", line));
  } else if (name == "elif" || name == "else") {
    BITELINE_TRY(next_part(row, name == "elif", line));
  } else if (name == "halt" || name == "return") {
    code_.instructions.push_back(
        {.kind = name == "halt" ? Instruction::Kind::Halt : Instruction::Kind::Return, .line = line});
  } else {
    BITELINE_TRY(statement(row, std::move(name), text, line));
  }
  return false;
}

std::optional<double> RunningThread::number_of(const Instruction& now, const ScriptWorld& world,
                                               const ScriptVariables& globals) const {
  const std::optional<ScriptValue> value = value_of(now.value, locals_, globals, world);
  if (!value || !std::holds_alternative<double>(*value)) return std::nullopt;
  return std::get<double>(*value);
}

bool RunningThread::assign(const Instruction& now, const ScriptWorld& world, ScriptVariables& globals) {
  const std::optional<ScriptValue> value = value_of(now.value, locals_, globals, world);
  if (!value) return false;
  const bool own = now.local || locals_.contains(now.name);
  (own ? locals_ : globals).insert_or_assign(now.name, *value);
  return true;
}

bool RunningThread::act(const Instruction& now, const ScriptWorld& world,
                        const ScriptVariables& globals) const {
  std::vector<ScriptValue> values;
  for (const Expression& argument : now.arguments) {
    const std::optional<ScriptValue> value = value_of(argument, locals_, globals, world);
    if (!value) return false;
    values.push_back(*value);
  }
  return !world.act || world.act(now.name, values);
}

bool RunningThread::run_until(double time_s, const ScriptWorld& world, ScriptVariables& globals) {
  using Kind = Instruction::Kind;
  for (int done = 0; done < k_most_in_a_frame && at_ < code_->instructions.size() && time_s >= wake_s_;
       ++done) {
    const Instruction& now = code_->instructions[at_++];
    if (now.kind == Kind::Sync) return false;
    if (now.kind == Kind::Halt) return true;
    if (now.kind == Kind::Jump || now.kind == Kind::Return) {
      at_ = now.kind == Kind::Jump ? now.target : code_->instructions.size();
      continue;
    }
    if (now.kind == Kind::Assign) {
      if (!assign(now, world, globals)) return true;
      continue;
    }
    if (now.kind == Kind::Act) {
      if (!act(now, world, globals)) return true;
      continue;
    }
    const std::optional<double> value = number_of(now, world, globals);
    if (!value) return true;
    if (now.kind == Kind::JumpUnless && *value == 0) at_ = now.target;
    if (now.kind == Kind::Sleep) wake_s_ = time_s + std::max(0.0, *value);
    if (now.kind == Kind::Output) world.set_output(now.output, *value != 0);
    if (now.kind == Kind::Analog) world.set_analog(now.output, std::clamp(*value, 0.0, 1.0));
  }
  return false;
}

}  // namespace biteline::sim
