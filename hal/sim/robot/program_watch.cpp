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
  if (running.program != program_ || running.begin != begin_) {
    program_ = running.program;
    begin_ = running.begin;
    events_done_ = 0;
    threads_.clear();
    watchdogs_.clear();
  }
  if (!program_) return {};
  const double time_s = seconds(instant - begin_);
  begin_events(running.time_s, time_s);
  const RunningThread::World world{
      .input_register = [&](int number) { return inputs.input_register(number); },
      .set_output = [&](int number, bool on) { arm_.set_output(number, on, instant); }};
  for (auto& [name, thread] : threads_) {
    if (!thread.run_until(time_s, world)) continue;
    arm_.stop(instant);
    return "thread " + name + " halted the program";
  }
  return look_at_watchdogs(instant, inputs);
}

void ProgramWatch::begin_events(double program_s, double time_s) {
  const auto& events = program_->events();
  for (; events_done_ < events.size() && events[events_done_].time_s <= program_s; ++events_done_) {
    const ProgramEvent& event = events[events_done_];
    if (const auto* run = std::get_if<RunThreadStep>(&event.step)) {
      const ThreadCode* code = program_->thread(run->name);
      if (code != nullptr) threads_.insert_or_assign(run->name, RunningThread{*code, time_s});
    } else if (const auto* kill = std::get_if<KillThreadStep>(&event.step)) {
      threads_.erase(kill->name);
    } else if (const auto* watchdog = std::get_if<WatchdogStep>(&event.step)) {
      watchdogs_.insert_or_assign(watchdog->variable, Watchdog{time_s, *watchdog});
    }
  }
}

std::string ProgramWatch::look_at_watchdogs(SensorClock::time_point instant, const RtdeInputs& inputs) {
  for (const auto& [variable, watchdog] : watchdogs_) {
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
