// SPDX-License-Identifier: MIT
#pragma once
/// \file Code with conditions and loops: a thread, or a program's main part, read; threads are run here.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/sim/robot/script_expression.hpp"

namespace biteline::sim {

struct Instruction {
  enum class Kind { Assign, Jump, JumpUnless, Sleep, Sync, Output, Analog, Act, Halt, Return, Row };
  Kind kind{Kind::Sync};
  int line{0};
  std::string name{};     ///< Assign: the variable; Row: its text; Act: the function
  bool local{false};      ///< Assign: it is the thread's own
  Expression value{};     ///< Assign, JumpUnless, Sleep; Output: on or off; Analog: 0 to 1
  std::size_t target{0};  ///< Jump, JumpUnless
  int output{0};
  std::vector<Expression> arguments{};  ///< Act
};

struct ScriptCode {
  std::string name;
  std::vector<Instruction> instructions;
};

/// Takes the lines after `thread name():` or `def name():` one by one.  A thread watches registers and
/// switches outputs; in a main part each call of a step is a Row, which script_rows.hpp reads when it is run.
class CodeReader {
 public:
  enum class Part { Thread, Main };
  CodeReader(std::string name, Part part) : part_{part} { code_.name = std::move(name); }
  /// `row` without comment and blanks at its end.  true: it was the `end` of the whole.
  [[nodiscard]] Result<bool> take(std::string_view row, int line);
  /// Each block has its `end`.
  [[nodiscard]] bool is_whole() const { return blocks_.empty(); }
  [[nodiscard]] ScriptCode code() && { return std::move(code_); }

 private:
  struct Block {
    std::optional<std::size_t> test;  ///< the instruction that leaves it, or goes to its next part
    std::size_t begin;
    bool loop;
    std::vector<std::size_t> exits{};  ///< from the end of a part that is done
  };
  [[nodiscard]] Result<void> begin_block(RowReader& row, bool loop, int line);
  [[nodiscard]] Result<void> next_part(RowReader& row, bool has_test, int line);
  /// true: it was the whole's.
  [[nodiscard]] bool end_block();
  [[nodiscard]] Result<void> statement(RowReader& row, std::string name, std::string_view text, int line);

  Part part_;
  ScriptCode code_;
  std::vector<Block> blocks_;
};

/// A thread that runs, on the controller's cycles.
class RunningThread {
 public:
  explicit RunningThread(const ScriptCode& code, double begin_s) : code_{&code}, wake_s_{begin_s} {}

  /// All that it does by `time_s`.  A variable that is not the thread's own is the program's.  true: it halts
  /// the program, by its own word or because a value is none.
  [[nodiscard]] bool run_until(double time_s, const ScriptWorld& world, ScriptVariables& globals);

 private:
  /// Of the instruction at hand.  nullopt: it is none.
  [[nodiscard]] std::optional<double> number_of(const Instruction& now, const ScriptWorld& world,
                                                const ScriptVariables& globals) const;
  [[nodiscard]] bool assign(const Instruction& now, const ScriptWorld& world, ScriptVariables& globals);
  [[nodiscard]] bool act(const Instruction& now, const ScriptWorld& world,
                         const ScriptVariables& globals) const;

  const ScriptCode* code_;
  ScriptVariables locals_;
  std::size_t at_{0};
  double wake_s_;
};

}  // namespace biteline::sim
