// SPDX-License-Identifier: MIT
#pragma once
/// \file What runs beside a program's moves: its threads, and the watchdogs it has set on RTDE inputs.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hal/sim/robot/arm.hpp"
#include "hal/sim/robot/program_threads.hpp"

namespace biteline::sim {

/// Where inputs of RTDE clients come from.
class RtdeInputs {
 public:
  virtual ~RtdeInputs() = default;
  [[nodiscard]] virtual int input_register(int number) const = 0;
  /// When a client wrote it last, as it was read from the socket; nothing: never.
  [[nodiscard]] virtual std::optional<SensorClock::time_point> written(const std::string& variable) const = 0;
};

/// What became of the program that is on, and what it says.
struct ProgramNews {
  enum class Kind { Started, Ended, Warning, Text, Popup, BlockingPopup, ProtectiveStop, OutOfReach, Fault };
  Kind kind;
  std::string text;  ///< of the program; Started, Ended: its name
};

/// One call each cycle of the controller, by its time.  As Universal Robots' script manual has it: watchdogs
/// and threads end with their program, and outputs stay as they are when it does. Single-threaded.
class ProgramWatch {
 public:
  /// `step_s`: of the controller's cycle.
  ProgramWatch(Arm& arm, double step_s) : arm_{arm}, step_s_{step_s} {}

  /// Force control and output registers, for threads: see ScriptWorld.
  struct Beside {
    std::function<ScriptPose()> tcp_force;
    std::function<bool(std::string_view function, std::span<const ScriptValue> arguments)> act;
    std::function<void()> program_ended;
    std::function<bool(int number)> digital_in{};
    std::function<double(int number)> analog_in{};
  };
  void set_beside(Beside beside) { beside_ = std::move(beside); }

  /// What ended the program, for the log; empty: nothing.
  [[nodiscard]] std::string step(SensorClock::time_point instant, const RtdeInputs& inputs);
  /// Since the last call, in order.
  [[nodiscard]] std::vector<ProgramNews> take_news() { return std::exchange(news_, {}); }
  /// For what is worked out at `instant`.
  [[nodiscard]] ScriptWorld world_at(SensorClock::time_point instant, const RtdeInputs& inputs);

 private:
  void tell_end();
  [[nodiscard]] std::string look_at_watchdogs(SensorClock::time_point instant, const RtdeInputs& inputs);

  Arm& arm_;
  Beside beside_{};
  double step_s_;
  std::optional<ProgramThreads> threads_{};
  bool ended_{false};  ///< the program whose threads those were
  std::vector<ProgramNews> news_{};
  SensorClock::time_point begin_;
};

}  // namespace biteline::sim
