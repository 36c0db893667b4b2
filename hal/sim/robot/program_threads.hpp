// SPDX-License-Identifier: MIT
#pragma once
/// \file A program's threads, run as its moves come to where it starts, tells and kills them.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "hal/sim/robot/program.hpp"

namespace biteline::sim {

/// One call each cycle, by the controller's time; real or made.
class ProgramThreads {
 public:
  explicit ProgramThreads(std::shared_ptr<const Program> program) : program_{std::move(program)} {}

  struct Watchdog {
    double begin_s;
    WatchdogStep told;
  };

  /// What the program tells until `program_s` of its own time, which is `time_s` after its begin.  What is
  /// for others than its threads: texts, popups, and what ends it.
  [[nodiscard]] std::vector<ScriptStep> tell_until(double program_s, double time_s);
  /// All that threads do by then.  The thread that halts the program; empty: none.
  [[nodiscard]] std::string step(double time_s, const ScriptWorld& world);
  /// Set so far, by their variables.
  [[nodiscard]] const std::map<std::string, Watchdog>& watchdogs() const { return watchdogs_; }
  [[nodiscard]] const std::shared_ptr<const Program>& program() const { return program_; }

 private:
  /// false: it is for others.
  bool take(const ScriptStep& step, double time_s);

  std::shared_ptr<const Program> program_;
  std::size_t events_done_{0};
  std::map<std::string, RunningThread> threads_;
  std::map<std::string, Watchdog> watchdogs_;
  ScriptVariables globals_;
};

}  // namespace biteline::sim
