// SPDX-License-Identifier: MIT
#include "hal/sim/robot/thread_code.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace biteline::sim {
namespace {

// What a thread may do without sleep or sync before its frame is over.
constexpr int k_most_in_a_frame = 10'000;

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Reads one row of a thread's body.
class Row {
 public:
  Row(std::string_view text, int line) : text_{text}, line_{line} {}

  [[nodiscard]] bool at_end() {
    skip();
    return text_.empty();
  }
  std::string word() {
    skip();
    const auto end = std::ranges::find_if_not(text_, is_word);
    std::string found(text_.begin(), end);
    text_.remove_prefix(found.size());
    return found;
  }
  bool take(std::string_view expected) {
    skip();
    if (!text_.starts_with(expected)) return false;
    text_.remove_prefix(expected.size());
    return true;
  }
  [[nodiscard]] tl::unexpected<Error> wrong(const char* expected) const {
    return fail(Errc::BadFormat, "script line %d: %s expected at '%.*s'", line_, expected,
                static_cast<int>(std::min<std::size_t>(text_.size(), 30)), text_.data());
  }
  [[nodiscard]] tl::unexpected<Error> unknown(const std::string& name) const {
    return fail(Errc::NotSupported, "script line %d: '%s' is not simulated in a thread", line_, name.c_str());
  }

  Result<Operand> operand() {
    skip();
    if (text_.empty()) return wrong("a value");
    if (std::isalpha(static_cast<unsigned char>(text_.front())) == 0 && text_.front() != '_') {
      BITELINE_ASSIGN(const double number, this->number());
      return Operand{number};
    }
    const std::string name = word();
    if (name == "True" || name == "False") return Operand{name == "True" ? 1.0 : 0.0};
    if (!take("(")) return Operand{name};
    if (name != "read_input_integer_register") return unknown(name);
    BITELINE_ASSIGN(const double number, this->number());
    if (!take(")")) return wrong("')'");
    return Operand{Operand::Register{static_cast<int>(number)}};
  }
  Result<Expression> expression() {
    Expression found;
    BITELINE_ASSIGN(found.left, operand());
    for (const char* op : {"==", "!=", "<=", ">=", "<", ">", "+", "-"}) {
      if (!take(op)) continue;
      found.op = op;
      BITELINE_ASSIGN(found.right, operand());
      break;
    }
    return found;
  }
  Result<double> number() {
    skip();
    const std::string copy(text_.substr(0, 64));
    char* end = nullptr;
    const double value = std::strtod(copy.c_str(), &end);
    if (end == copy.c_str() || !(std::abs(value) <= 1e9)) return wrong("a number");
    text_.remove_prefix(static_cast<std::size_t>(end - copy.c_str()));
    return value;
  }

 private:
  void skip() {
    while (!text_.empty() && (text_.front() == ' ' || text_.front() == '\t')) text_.remove_prefix(1);
  }
  std::string_view text_;
  int line_;
};

/// A call that stands alone.
Result<std::optional<Instruction>> call(Row& row, const std::string& name) {
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
  } else {
    return row.unknown(name);
  }
  if (!row.take(")")) return row.wrong("')'");
  return std::optional{found};
}

}  // namespace

Result<bool> ThreadReader::take(std::string_view text, int line) {
  Row row{text, line};
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
  if (name == "local" || name == "global") name = row.word();
  if (row.take("(")) {
    BITELINE_ASSIGN(auto instruction, call(row, name));
    if (instruction) all.push_back(std::move(*instruction));
  } else if (row.take("=")) {
    Instruction assign{.kind = Instruction::Kind::Assign, .name = name};
    BITELINE_ASSIGN(assign.value, row.expression());
    all.push_back(std::move(assign));
  } else {
    return row.unknown(name);
  }
  if (!row.at_end()) return row.wrong("the end of the line");
  return false;
}

double RunningThread::value_of(const Operand& operand, const World& world) const {
  if (const auto* number = std::get_if<double>(&operand.value)) return *number;
  if (const auto* reg = std::get_if<Operand::Register>(&operand.value))
    return world.input_register(reg->number);
  const auto known = variables_.find(std::get<std::string>(operand.value));
  return known == variables_.end() ? 0 : known->second;
}

double RunningThread::value_of(const Expression& expression, const World& world) const {
  const double a = value_of(expression.left, world);
  if (expression.op.empty()) return a;
  const double b = value_of(expression.right, world);
  if (expression.op == "+") return a + b;
  if (expression.op == "-") return a - b;
  const bool holds = expression.op == "=="   ? a == b
                     : expression.op == "!=" ? a != b
                     : expression.op == "<=" ? a <= b
                     : expression.op == ">=" ? a >= b
                     : expression.op == "<"  ? a < b
                                             : a > b;
  return holds ? 1 : 0;
}

bool RunningThread::run_until(double time_s, const World& world) {
  for (int done = 0; done < k_most_in_a_frame && at_ < code_->instructions.size() && time_s >= wake_s_;
       ++done) {
    const Instruction& now = code_->instructions[at_++];
    switch (now.kind) {
      case Instruction::Kind::Assign:
        variables_[now.name] = value_of(now.value, world);
        break;
      case Instruction::Kind::Jump:
        at_ = now.target;
        break;
      case Instruction::Kind::JumpUnless:
        if (value_of(now.value, world) == 0) at_ = now.target;
        break;
      case Instruction::Kind::Sleep:
        wake_s_ = time_s + std::max(0.0, value_of(now.value, world));
        break;
      case Instruction::Kind::Sync:
        return false;
      case Instruction::Kind::Output:
        world.set_output(now.output, value_of(now.value, world) != 0);
        break;
      case Instruction::Kind::Halt:
        return true;
      case Instruction::Kind::Return:
        at_ = code_->instructions.size();
        break;
    }
  }
  return false;
}

}  // namespace biteline::sim
