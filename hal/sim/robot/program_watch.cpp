// SPDX-License-Identifier: MIT
#include "hal/sim/robot/program_watch.hpp"

#include <algorithm>

namespace biteline::sim {
namespace {

double seconds(Nanoseconds time) {
  return static_cast<double>(time.count()) * 1e-9;
}

ProgramNews news_of(const ScriptStep& step) {
  using Kind = ProgramNews::Kind;
  if (const auto* text = std::get_if<TextStep>(&step)) return {.kind = Kind::Text, .text = text->text};
  if (const auto* popup = std::get_if<PopupStep>(&step))
    return {.kind = popup->blocking ? Kind::BlockingPopup : Kind::Popup, .text = popup->text};
  if (const auto* fault = std::get_if<FaultStep>(&step)) return {.kind = Kind::Fault, .text = fault->text};
  const auto* stop = std::get_if<ProtectiveStopStep>(&step);
  return {.kind = stop != nullptr && stop->out_of_reach ? Kind::OutOfReach : Kind::ProtectiveStop,
          .text = {}};
}

}  // namespace

void ProgramWatch::tell_end() {
  if (std::exchange(ended_, true)) return;
  if (beside_.program_ended) beside_.program_ended();
  news_.push_back({.kind = ProgramNews::Kind::Ended, .text = threads_->program()->name()});
}

std::string ProgramWatch::step(SensorClock::time_point instant, const RtdeInputs& inputs) {
  const Arm::Running running = arm_.running(instant);
  const bool same = threads_ && running.program == threads_->program() && running.begin == begin_;
  if (threads_ && !same) {
    tell_end();
    threads_.reset();
  }
  if (!running.program) return {};
  if (!same) {
    threads_.emplace(running.program);
    begin_ = running.begin;
    ended_ = false;
    news_.push_back({.kind = ProgramNews::Kind::Started, .text = running.program->name()});
  }
  if (ended_) return {};
  const double time_s = seconds(instant - begin_);
  for (const ScriptStep& step : threads_->tell_until(running.time_s, time_s)) news_.push_back(news_of(step));
  if (running.ended) {
    tell_end();
    return {};
  }
  if (running.paused) return {};
  const std::string halts = threads_->step(time_s, world_at(instant, inputs));
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
              },
          .tcp_force = beside_.tcp_force,
          .digital_in = beside_.digital_in,
          .analog_in = beside_.analog_in,
          .act = beside_.act};
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
