// SPDX-License-Identifier: MIT
#include "hal/sim/robot/program_threads.hpp"

namespace biteline::sim {

std::string ProgramThreads::step(double program_s, double time_s, const ScriptWorld& world) {
  const auto& events = program_->events();
  for (; events_done_ < events.size() && events[events_done_].time_s <= program_s; ++events_done_)
    take(events[events_done_].step, time_s);
  for (auto& [name, thread] : threads_) {
    if (thread.run_until(time_s, world, globals_)) return name;
  }
  return {};
}

void ProgramThreads::take(const ScriptStep& step, double time_s) {
  if (const auto* run = std::get_if<RunThreadStep>(&step)) {
    const ThreadCode* code = program_->thread(run->name);
    if (code != nullptr) threads_.insert_or_assign(run->name, RunningThread{*code, time_s});
  } else if (const auto* kill = std::get_if<KillThreadStep>(&step)) {
    threads_.erase(kill->name);
  } else if (const auto* watchdog = std::get_if<WatchdogStep>(&step)) {
    watchdogs_.insert_or_assign(watchdog->variable, Watchdog{time_s, *watchdog});
  } else if (const auto* assign = std::get_if<AssignStep>(&step)) {
    globals_.insert_or_assign(assign->name, assign->value);
  }
}

}  // namespace biteline::sim
