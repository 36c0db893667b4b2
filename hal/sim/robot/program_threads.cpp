// SPDX-License-Identifier: MIT
#include "hal/sim/robot/program_threads.hpp"

namespace biteline::sim {

std::vector<ScriptStep> ProgramThreads::tell_until(double program_s, double time_s) {
  std::vector<ScriptStep> for_others;
  const auto& events = program_->events();
  for (; events_done_ < events.size() && events[events_done_].time_s <= program_s; ++events_done_) {
    if (!take(events[events_done_].step, time_s)) for_others.push_back(events[events_done_].step);
  }
  return for_others;
}

std::string ProgramThreads::step(double time_s, const ScriptWorld& world) {
  for (auto& [name, thread] : threads_) {
    if (thread.run_until(time_s, world, globals_)) return name;
  }
  return {};
}

bool ProgramThreads::take(const ScriptStep& step, double time_s) {
  if (const auto* run = std::get_if<RunThreadStep>(&step)) {
    const ScriptCode* code = program_->thread(run->name);
    if (code != nullptr) threads_.insert_or_assign(run->name, RunningThread{*code, time_s});
  } else if (const auto* kill = std::get_if<KillThreadStep>(&step)) {
    threads_.erase(kill->name);
  } else if (const auto* watchdog = std::get_if<WatchdogStep>(&step)) {
    watchdogs_.insert_or_assign(watchdog->variable, Watchdog{time_s, *watchdog});
  } else if (const auto* assign = std::get_if<AssignStep>(&step)) {
    globals_.insert_or_assign(assign->name, assign->value);
  } else {
    return std::holds_alternative<DigitalOutStep>(step) || std::holds_alternative<AnalogOutStep>(step);
  }
  return true;
}

}  // namespace biteline::sim
