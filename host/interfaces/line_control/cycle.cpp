// SPDX-License-Identifier: MIT
#include "host/interfaces/line_control/cycle.hpp"

#include <algorithm>
#include <cstdlib>

namespace biteline::line_control {
namespace {

constexpr int k_most_request = 65535;

Verdict verdict_of(const std::string& word) {
  if (word == "ok") return Verdict::Ok;
  if (word == "amber") return Verdict::Amber;
  if (word == "review") return Verdict::Review;
  if (word == "refused") return Verdict::Refused;
  return Verdict::Failed;
}

int number_of_scan(const std::string& name) {
  const std::size_t dash = name.find('-');
  return dash == std::string::npos ? 0 : std::atoi(name.c_str() + dash + 1);
}

}  // namespace

const Job* Cycle::find(int number) const {
  const auto found = std::ranges::find(jobs_, number, &Job::number);
  return found == jobs_.end() ? nullptr : &*found;
}

Refusal Cycle::choose(int number, const Standing& standing) {
  if (find(number) == nullptr) return Refusal::UnknownJob;
  // Controls that write all their registers each turn change nothing by it.
  if (number == state_.job) return Refusal::None;
  if (standing.control_held) return Refusal::ControlHeld;
  if (busy()) return Refusal::Busy;
  state_.job = number;
  return Refusal::None;
}

Cycle::Start Cycle::start(int request, const Standing& standing) {
  if (request < 1 || request > k_most_request) return {.refusal = Refusal::BadRequest};
  // Said again after a lost answer: it was taken, whatever has become of it.
  if (request == state_.taken) return {};
  if (standing.control_held) return {.refusal = Refusal::ControlHeld};
  if (standing.stopped) return {.refusal = Refusal::Stopped};
  if (standing.deciding) return {.refusal = Refusal::Deciding};
  if (busy()) return {.refusal = Refusal::Busy};
  if (!standing.sensor) return {.refusal = Refusal::NotReady};
  const Job* const job = find(state_.job);
  if (job == nullptr) return {.refusal = Refusal::NoJob};
  return {.refusal = Refusal::None, .go = *job, .part = begin(request)};
}

Refusal Cycle::choose_part(const std::string& part, const Standing& standing) {
  // As of a job: whoever says all of it each turn changes nothing by it.
  if (part == (busy() ? part_in_work_ : next_part_)) return Refusal::None;
  if (standing.control_held) return Refusal::ControlHeld;
  if (busy()) return Refusal::Busy;
  next_part_ = part;
  return Refusal::None;
}

std::string Cycle::begin(int request, const std::string& part) {
  part_in_work_ = part.empty() ? next_part_ : part;
  next_part_.clear();
  ask_scan(request);
  return part_in_work_;
}

void Cycle::begin_again() {
  ask_scan(0);
}

void Cycle::ask_scan(int request) {
  phase_ = Phase::Asked;
  request_ = request;
  if (request > 0) state_.taken = request;
  state_.done = false;
  ++state_.counts.starts;
}

void Cycle::forget_part() {
  next_part_.clear();
  part_in_work_.clear();
}

void Cycle::scan_begins() {
  // Nobody asked for it here: one that an earlier service left, or of a recording.
  if (phase_ == Phase::Idle) {
    request_ = 0;
    part_in_work_.clear();
  }
  phase_ = Phase::InWork;
  state_.done = false;
}

void Cycle::scan_ends(const Ended& ended) {
  if (phase_ != Phase::InWork) return;
  finish(verdict_of(ended.verdict));
  state_.scan = number_of_scan(ended.scan);
  state_.sent = ended.sent;
  state_.followed = ended.followed;
  state_.length_mm = ended.length_mm;
  state_.u95_mm = ended.u95_mm;
  state_.confidence = ended.confidence;
  state_.part = ended.part;
  const auto is_of = [&ended](const Job& job) {
    const auto fits = [](const std::string& wanted, const std::string& is) {
      return wanted.empty() || wanted == is;
    };
    return job.model == ended.model && fits(job.foot, ended.foot) && fits(job.size, ended.size);
  };
  const auto job = std::ranges::find_if(jobs_, is_of);
  state_.model = ended.model.empty() || job == jobs_.end() ? 0 : job->number;
}

void Cycle::give_up() {
  if (phase_ != Phase::Asked) return;
  finish(Verdict::Failed);
  state_.scan = 0;
  state_.sent = state_.followed = false;
  state_.length_mm = state_.u95_mm = state_.confidence = std::nullopt;
  state_.model = 0;
  state_.part.clear();
}

void Cycle::finish(Verdict verdict) {
  phase_ = Phase::Idle;
  state_.done = true;
  state_.finished = request_;
  state_.verdict = verdict;
  Counts& counts = state_.counts;
  switch (verdict) {
    case Verdict::Ok:
      ++counts.ok;
      return;
    case Verdict::Amber:
      ++counts.amber;
      return;
    case Verdict::Review:
      ++counts.review;
      return;
    case Verdict::Refused:
      ++counts.refused;
      return;
    case Verdict::Failed:
    case Verdict::None:
      ++counts.failed;
      return;
  }
}

LineState Cycle::state(const Standing& standing, Step working, bool fault) const {
  LineState state = state_;
  state.busy = busy();
  state.next_part = busy() ? part_in_work_ : next_part_;
  if (standing.stopped) {
    state.step = Step::Stopped;
  } else if (standing.deciding) {
    state.step = Step::Deciding;
  } else if (phase_ == Phase::InWork) {
    state.step = working;
  } else if (fault || !standing.sensor) {
    state.step = Step::Fault;
  } else {
    state.step = phase_ == Phase::Asked ? Step::Scanning : Step::Ready;
  }
  return state;
}

}  // namespace biteline::line_control
