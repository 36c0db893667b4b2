// SPDX-License-Identifier: MIT
#include "hal/sim/robot/thread_code.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace biteline::sim {
namespace {

// What a thread may do without sleep or sync before its frame is over.
constexpr int k_most_in_a_frame = 10'000;

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
  } else {
    return row.unknown(name);
  }
  if (!row.take(")")) return row.wrong("')'");
  return found;
}

}  // namespace

Result<bool> ThreadReader::take(std::string_view text, int line) {
  RowReader row{text, line};
  std::string name = row.word();
  std::vector<Instruction>& all = code_.instructions;
  if (name == "while" || name == "if") {
    Instruction test{.kind = Instruction::Kind::JumpUnless};
    BITELINE_ASSIGN(test.value, row.expression());
    if (!row.take(":") || !row.at_end()) return row.wrong("':'");
    blocks_.push_back({.test = all.size(), .begin = all.size(), .loop = name == "while"});
    all.push_back(std::move(test));
    return false;
  }
  if (name == "else") {
    if (!row.take(":") || blocks_.empty() || blocks_.back().loop) return row.wrong("an 'if' before 'else:'");
    all.push_back({.kind = Instruction::Kind::Jump});
    all[blocks_.back().test].target = all.size();
    blocks_.back().test = all.size() - 1;
    return false;
  }
  if (name == "end") {
    if (blocks_.empty()) return true;
    const Block block = blocks_.back();
    blocks_.pop_back();
    if (block.loop) all.push_back({.kind = Instruction::Kind::Jump, .target = block.begin});
    all[block.test].target = all.size();
    return false;
  }
  if (name == "halt" || name == "return") {
    all.push_back({.kind = name == "halt" ? Instruction::Kind::Halt : Instruction::Kind::Return});
    return false;
  }
  const bool local = name == "local";
  if (local || name == "global") name = row.word();
  if (row.take("(")) {
    BITELINE_ASSIGN(Instruction instruction, call(row, name));
    all.push_back(std::move(instruction));
  } else if (row.take("=")) {
    Instruction assign{.kind = Instruction::Kind::Assign, .name = name, .local = local};
    BITELINE_ASSIGN(assign.value, row.expression());
    all.push_back(std::move(assign));
  } else {
    return row.unknown(name);
  }
  if (!row.at_end()) return row.wrong("the end of the line");
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
