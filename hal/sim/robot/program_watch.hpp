// SPDX-License-Identifier: MIT
#pragma once
/// \file What runs beside a program's moves: its threads, and the watchdogs it has set on RTDE inputs.

#include <map>
#include <memory>
#include <string>

#include "hal/sim/robot/arm.hpp"

namespace biteline::sim {

/// Where inputs of RTDE clients come from.
class RtdeInputs {
 public:
  virtual ~RtdeInputs() = default;
  [[nodiscard]] virtual int input_register(int number) const = 0;
  /// When a client wrote it last, as it was read from the socket; nothing: never.
  [[nodiscard]] virtual std::optional<SensorClock::time_point> written(const std::string& variable) const = 0;
};

/// One call each cycle of the controller, by its time.  As Universal Robots' script manual has it: watchdogs
/// and threads end with their program, and outputs stay as they are when it does. Single-threaded.
class ProgramWatch {
 public:
  explicit ProgramWatch(Arm& arm) : arm_{arm} {}

  /// What ended the program, for the log; empty: nothing.
  [[nodiscard]] std::string step(SensorClock::time_point instant, const RtdeInputs& inputs);

 private:
  struct Watchdog {
    double begin_s;
    WatchdogStep told;
  };
  /// Of the program until `program_s` of its own time, which is `time_s` after its begin.
  void begin_events(double program_s, double time_s);
  [[nodiscard]] std::string look_at_watchdogs(SensorClock::time_point instant, const RtdeInputs& inputs);

  Arm& arm_;
  std::shared_ptr<const Program> program_;
  SensorClock::time_point begin_;
  std::size_t events_done_{0};
  std::map<std::string, RunningThread> threads_;
  std::map<std::string, Watchdog> watchdogs_;
};

}  // namespace biteline::sim
