// SPDX-License-Identifier: MIT
#pragma once
/// \file The controller's runtime: the one program that is on, plain or with control flow.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/sim/robot/program_text.hpp"
#include "hal/sim/robot/program_watch.hpp"

namespace biteline::sim {

/// A plain program is the arm's as a whole.  One with control flow is given to the arm a run of rows at a
/// time, each when the one before has ended.  Single-threaded.
class ScriptRunner {
 public:
  /// `step_s`: of the controller's cycle.
  ScriptRunner(Arm& arm, double step_s) : arm_{arm}, watch_{arm, step_s} {}

  void set_beside(ProgramWatch::Beside beside) { watch_.set_beside(std::move(beside)); }

  /// Takes the place of what is on.  `q_rad`: of the arm, where they are known.  A secondary program moves
  /// nothing, and what is on goes on.
  void run(ProgramText program, const std::optional<JointVector>& q_rad, SensorClock::time_point instant);
  void stop(SensorClock::time_point instant);
  void set_paused(bool on, SensorClock::time_point instant);

  /// One cycle.  What ended the program, for the log; empty: nothing.
  [[nodiscard]] std::string step(SensorClock::time_point instant, const RtdeInputs& inputs,
                                 const std::optional<JointVector>& q_rad);
  /// Since the last call, in order.
  [[nodiscard]] std::vector<ProgramNews> take_news() { return std::exchange(news_, {}); }
  /// A program with control flow is on: also between its runs of rows.
  [[nodiscard]] const std::string* code_name() const { return code_ ? &code_->name : nullptr; }
  [[nodiscard]] bool is_paused() const { return paused_; }

 private:
  void run_plain(Script script, const std::optional<JointVector>& q_rad, SensorClock::time_point instant);
  void run_secondary(const Script& script, SensorClock::time_point instant);
  void end_code();
  void take(const ProgramNews& news);
  /// Until it gives the arm something to do, waits for the next cycle, or ends.
  [[nodiscard]] Result<void> advance(SensorClock::time_point instant, const RtdeInputs& inputs,
                                     const std::optional<JointVector>& q_rad);
  /// The rows from here on as steps, as values are now: a program without a name, of which nobody is told.
  [[nodiscard]] Result<Script> next_rows(const ScriptWorld& world);

  Arm& arm_;
  ProgramWatch watch_;
  std::vector<ProgramNews> news_;
  std::optional<ScriptCode> code_;
  std::size_t at_{0};
  ScriptVariables variables_;
  std::shared_ptr<const Program> rows_;  ///< what the arm was given of the code last
  bool paused_{false};
};

}  // namespace biteline::sim
