// SPDX-License-Identifier: MIT
#include "hal/sim/robot/program_watch.hpp"

#include <algorithm>

namespace biteline::sim {
namespace {

double seconds(Nanoseconds time) {
  return static_cast<double>(time.count()) * 1e-9;
}

}  // namespace

std::string ProgramWatch::step(SensorClock::time_point instant, const RtdeInputs& inputs) {
  const Arm::Running running = arm_.running(instant);
  if (!running.program) {
    threads_.reset();
    return {};
  }
  if (!threads_ || running.program != threads_->program() || running.begin != begin_) {
    threads_.emplace(running.program);
    begin_ = running.begin;
  }
  const std::string halts =
      threads_->step(running.time_s, seconds(instant - begin_), world_at(instant, inputs));
  if (halts.empty()) return look_at_watchdogs(instant, inputs);
  arm_.stop(instant);
  return "thread " + halts + " halted the program";
}

ScriptWorld ProgramWatch::world_at(SensorClock::time_point instant, const RtdeInputs& inputs) {
  return {.input_register = [&inputs](int number) { return inputs.input_register(number); },
          .T_base_tcp =
              [this, instant](bool actual) {
                const ArmState target = arm_.at(instant);
                return SE3{(actual ? arm_.real_at(instant).T_base_flange_told : target.T_base_flange) *
                           target.T_flange_tcp};
              },
          .step_s = step_s_,
          .set_output =
              [this, instant](int number, bool on) {
                arm_.set_output(DigitalOutStep{number, on}, instant);
              },
          .set_analog =
              [this, instant](int number, double ratio) {
                arm_.set_output(AnalogOutStep{number, ratio}, instant);
              }};
}

std::string ProgramWatch::look_at_watchdogs(SensorClock::time_point instant, const RtdeInputs& inputs) {
  for (const auto& [variable, watchdog] : threads_->watchdogs()) {
    if (!watchdog.told.stops) continue;
    const double time_s = seconds(instant - begin_);
    double fed_s = watchdog.begin_s;
    if (const auto written = inputs.written(variable)) fed_s = std::max(fed_s, seconds(*written - begin_));
    if (time_s - fed_s <= 1 / watchdog.told.min_hz) continue;
    arm_.stop(instant);
    return "RTDE watchdog: no update of " + variable;
  }
  return {};
}

}  // namespace biteline::sim
