// SPDX-License-Identifier: MIT
#pragma once
/// \file A URScript thread, of what watches registers and switches outputs, read and run.

#include <string>
#include <string_view>
#include <vector>

#include "hal/sim/robot/script_expression.hpp"

namespace biteline::sim {

struct Instruction {
  enum class Kind { Assign, Jump, JumpUnless, Sleep, Sync, Output, Analog, Halt, Return };
  Kind kind{Kind::Sync};
  std::string name{};     ///< Assign: the variable
  bool local{false};      ///< Assign: it is the thread's own
  Expression value{};     ///< Assign, JumpUnless, Sleep; Output: on or off; Analog: 0 to 1
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

  /// All that it does by `time_s`.  A variable that is not the thread's own is the program's.  true: it halts
  /// the program, by its own word or because a value is none.
  [[nodiscard]] bool run_until(double time_s, const ScriptWorld& world, ScriptVariables& globals);

 private:
  /// Of the instruction at hand.  nullopt: it is none.
  [[nodiscard]] std::optional<double> number_of(const Instruction& now, const ScriptWorld& world,
                                                const ScriptVariables& globals) const;
  [[nodiscard]] bool assign(const Instruction& now, const ScriptWorld& world, ScriptVariables& globals);

  const ThreadCode* code_;
  ScriptVariables locals_;
  std::size_t at_{0};
  double wake_s_;
};

}  // namespace biteline::sim
