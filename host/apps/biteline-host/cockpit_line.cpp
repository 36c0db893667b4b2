// SPDX-License-Identifier: MIT
// The cockpit's face to the line's control: each start is one scan.
#include "host/apps/biteline-host/cockpit.hpp"

namespace biteline::service {

using line_control::Refusal;
using line_control::Step;

line_control::Standing Cockpit::standing_locked(bool control_held) const {
  return {.control_held = control_held,
          .deciding = !held_.empty(),
          .stopped = stopped_,
          .sensor = sensor_lost_.empty()};
}

bool Cockpit::waits_for_start() const {
  const std::lock_guard lock{mutex_};
  return cycle_.on_demand() && !stopped_;
}

void Cockpit::give_up_start() {
  const std::lock_guard lock{mutex_};
  if (!cycle_.on_demand()) return;
  cycle_.give_up();
  paused_ = true;
}

void Cockpit::pause_by_person() {
  give_up_start();
  const std::lock_guard lock{mutex_};
  paused_ = true;
  stopped_ = true;
}

void Cockpit::end_cycle(const memory::Scan& scan) {
  const std::lock_guard lock{mutex_};
  if (going_on_ == scan.name) going_on_.clear();
  cycle_.scan_ends({.scan = scan.name,
                    .verdict = scan.verdict,
                    .model = scan.model,
                    .sent = scan.sent,
                    .followed = scan.followed.value_or(false),
                    .length_mm = scan.length_mm,
                    .u95_mm = scan.u95_mm,
                    .confidence = scan.confidence});
}

line_control::LineState Cockpit::line_state() {
  const std::lock_guard lock{mutex_};
  const Step working = phase_ == Phase::Following  ? Step::Following
                       : phase_ == Phase::Scanning ? Step::Scanning
                                                   : Step::Working;
  return cycle_.state(standing_locked(false), working, phase_ == Phase::Fault);
}

std::optional<api::Job> Cockpit::job_of(int number) {
  // The jobs never change while the service runs.
  const line_control::Job* const job = cycle_.find(number);
  if (job == nullptr) return std::nullopt;
  return api::Job{.model = job->model, .process = job->process};
}

Refusal Cockpit::choose_job(int number, bool control_held) {
  const std::lock_guard lock{mutex_};
  return cycle_.choose(number, standing_locked(control_held));
}

api::Cell::LineStart Cockpit::start_for_line(int request, bool control_held) {
  std::optional<line_control::Job> job;
  {
    const std::lock_guard lock{mutex_};
    line_control::Cycle::Start start = cycle_.start(request, standing_locked(control_held));
    if (!start.go) return {.refusal = start.refusal, .fresh = false};
    job = std::move(start.go);
    hold_all_locked(false);
  }
  go({.model = job->model, .process = job->process}, "the line's control");
  static_cast<void>(keep_hold(false, "the line's control"));
  return {.refusal = Refusal::None, .fresh = true};
}

}  // namespace biteline::service
