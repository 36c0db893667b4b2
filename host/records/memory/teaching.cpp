// SPDX-License-Identifier: MIT
#include "host/records/memory/teaching.hpp"

namespace biteline::memory {
namespace {

std::string_view open_line(const Teaching& teaching) {
  if (teaching.verdict == "ok" || teaching.verdict == "amber") return {};
  return teaching.verdict == "review" ? "to_settle" : "no_line";
}

std::string_view open_process(const Teaching& teaching) {
  if (teaching.process_by.empty()) return "not_chosen";
  return teaching.has_path ? "" : "no_path";
}

std::string_view open_air(const Teaching& teaching) {
  if (teaching.followed && other_than(teaching.followed->work, teaching.work).empty()) return {};
  // What the arm did last with this very line and process says more than an older run.
  if (teaching.air && other_than(teaching.air->work, teaching.work).empty()) {
    if (teaching.air->outcome == "begun") return "running";
    return teaching.air->outcome == "refused" ? "refused" : "stopped";
  }
  return teaching.followed ? other_than(teaching.followed->work, teaching.work) : "not_run";
}

std::string_view open_dry_run(const Teaching& teaching) {
  // The arm itself has shown it.
  if (open_air(teaching).empty()) return {};
  return teaching.dry_run ? other_than(teaching.dry_run->work, teaching.work) : "not_seen";
}

}  // namespace

std::string_view other_than(const TaughtWork& done, const TaughtWork& now) {
  if (done.scan != now.scan) return "scanned_again";
  if (done.line_version != now.line_version) return "line_changed";
  return done.process_sha256 == now.process_sha256 ? "" : "process_changed";
}

TeachSteps steps_of(const Teaching& teaching) {
  TeachSteps steps;
  // Without a scan there is nothing that anything else could have been done with.
  const bool none = teaching.work.scan.empty();
  const std::array<std::string_view, k_teach_steps.size()> open{none ? "no_scan" : "",
                                                                none ? "no_line" : open_line(teaching),
                                                                none ? "not_chosen" : open_process(teaching),
                                                                none ? "not_seen" : open_dry_run(teaching),
                                                                none ? "not_run" : open_air(teaching),
                                                                teaching.model.empty() ? "not_saved" : ""};
  bool next = !teaching.ended;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i] = {.is = StepState::Is::Done, .why = open[i]};
    if (open[i].empty()) continue;
    steps[i].is = next ? StepState::Is::Now : StepState::Is::Open;
    next = false;
  }
  return steps;
}

std::optional<TeachStep> step_of(const Teaching& teaching) {
  const TeachSteps steps = steps_of(teaching);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i].is == StepState::Is::Now) return static_cast<TeachStep>(i);
  }
  return std::nullopt;
}

}  // namespace biteline::memory
