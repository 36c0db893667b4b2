// SPDX-License-Identifier: MIT
#pragma once
/// \file A URScript thread, of the little that watches registers and switches outputs, read and run.

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::sim {

/// A number (True is 1), a variable, or read_input_integer_register(n).
struct Operand {
  struct Register {
    int number;
  };
  std::variant<double, std::string, Register> value{0.0};
};

/// One operand, or two with + - == != < > <= >= between them.
struct Expression {
  Operand left;
  std::string op;  ///< empty: one operand
  Operand right;
};

struct Instruction {
  enum class Kind { Assign, Jump, JumpUnless, Sleep, Sync, Output, Halt, Return };
  Kind kind{Kind::Sync};
  std::string name{};     ///< Assign: the variable
  Expression value{};     ///< Assign, JumpUnless, Sleep; Output: on or off
  std::size_t target{0};  ///< Jump, JumpUnless
  int output{0};
};

struct ThreadCode {
  std::string name;
  std::vector<Instruction> instructions;
};

/// Takes the lines after `thread name():` one by one.
class ThreadReader {
 public:
  explicit ThreadReader(std::string name) { code_.name = std::move(name); }
  /// `row` without comment and blanks at its end.  true: it was the thread's `end`.
  [[nodiscard]] Result<bool> take(std::string_view row, int line);
  [[nodiscard]] ThreadCode code() && { return std::move(code_); }

 private:
  struct Block {
    std::size_t test;  ///< of the instruction that leaves it
    std::size_t begin;
    bool loop;
  };
  ThreadCode code_;
  std::vector<Block> blocks_;
};

/// A thread that runs, on the controller's cycles.
class RunningThread {
 public:
  explicit RunningThread(const ThreadCode& code, double begin_s) : code_{&code}, wake_s_{begin_s} {}

  struct World {
    std::function<int(int number)> input_register;
    std::function<void(int number, bool on)> set_output;
  };
  /// All that it does by `time_s`.  true: it halts the program.
  [[nodiscard]] bool run_until(double time_s, const World& world);

 private:
  [[nodiscard]] double value_of(const Operand& operand, const World& world) const;
  [[nodiscard]] double value_of(const Expression& expression, const World& world) const;

  const ThreadCode* code_;
  std::map<std::string, double> variables_;
  std::size_t at_{0};
  double wake_s_;
};

}  // namespace biteline::sim
