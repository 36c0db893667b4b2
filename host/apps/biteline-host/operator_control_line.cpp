// SPDX-License-Identifier: MIT
// The operator's face to the line's control: each start is one scan.
#include "host/apps/biteline-host/operator_control.hpp"
#include "host/apps/biteline-host/work_book.hpp"

namespace biteline::service {

using line_control::Refusal;
using line_control::Step;

line_control::Standing OperatorControl::standing_locked(bool control_held) const {
  return {.control_held = control_held,
          .deciding = cell_.shoe() == Shoe::Held,
          .stopped = cell_.going() == Going::Stopped,
          .sensor = sensor_lost_.empty()};
}

void OperatorControl::give_up_start() {
  const std::lock_guard lock{mutex_};
  if (!cycle_.on_demand()) return;
  cycle_.give_up();
  cell_.on(CellEvent::Spent);
}

void OperatorControl::end_cycle(const memory::Scan& scan) {
  const std::lock_guard lock{mutex_};
  if (mending_ == scan.name) mending_.clear();
  // A person must look at what was done.
  const bool settled = scan.work.verdict.empty() || scan.work.verdict == k_work_ok;
  cycle_.scan_ends({.scan = scan.name,
                    .verdict = settled ? scan.verdict : "review",
                    .model = scan.model,
                    .foot = scan.foot,
                    .size = scan.size,
                    .part = scan.part,
                    .sent = scan.sent,
                    .followed = scan.followed.value_or(false),
                    .length_mm = scan.length_mm,
                    .u95_mm = scan.u95_mm,
                    .confidence = scan.confidence});
}

line_control::LineState OperatorControl::line_state() {
  const std::lock_guard lock{mutex_};
  const CellState state = cell_.state(hindrance_);
  const Step working = state == CellState::Following  ? Step::Following
                       : state == CellState::Scanning ? Step::Scanning
                                                      : Step::Working;
  const bool fault = state == CellState::NoSensor || state == CellState::NotReady;
  return cycle_.state(standing_locked(false), working, fault);
}

std::optional<api::Job> OperatorControl::job_of(int number) {
  // The jobs never change while the service runs.
  const line_control::Job* const job = cycle_.find(number);
  if (job == nullptr) return std::nullopt;
  return api::Job{.model = job->model, .process = job->process, .foot = job->foot, .size = job->size};
}

Refusal OperatorControl::choose_job(int number, bool control_held) {
  const std::lock_guard lock{mutex_};
  return cycle_.choose(number, standing_locked(control_held));
}

Refusal OperatorControl::choose_part(const std::string& part, bool control_held) {
  const std::lock_guard lock{mutex_};
  return cycle_.choose_part(part, standing_locked(control_held));
}

api::Cell::LineStart OperatorControl::start_for_line(int request, bool control_held, std::uint64_t stops) {
  const robot::StopMark mark = stops_.at(stops);
  {
    const std::lock_guard lock{mutex_};
    line_control::Standing standing = standing_locked(control_held);
    // It waited, and somebody said stop meanwhile; who then started again did not mean this one.
    standing.stopped = standing.stopped || mark.stopped();
    const line_control::Cycle::Start start = cycle_.start(request, standing);
    if (!start.go) return {.refusal = start.refusal, .fresh = false};
    hold_all_locked(false);
    go_locked({.kind = OperatorCommand::Kind::Start,
               .who = "the line's control",
               .job = {.model = start.go->model,
                       .process = start.go->process,
                       .foot = start.go->foot,
                       .size = start.go->size,
                       .part = start.part},
               .mark = mark});
  }
  static_cast<void>(keep_hold(false, "the line's control"));
  return {.refusal = Refusal::None, .fresh = true};
}

}  // namespace biteline::service
