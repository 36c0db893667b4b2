// SPDX-License-Identifier: MIT
// What doors say: a stop, a start, a word about a scan, a mended line, a result worked out anew.
#include <utility>

#include "host/apps/biteline-host/operator_control.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/records/evidence/evidence.hpp"
#include "host/robot/link/gate/refused.hpp"

namespace biteline::service {
namespace {

/// Of an order that waited past a stop.
tl::unexpected<Error> over() {
  return fail(Errc::WrongState, "a stop came after this was said; start again, when the cell is clear");
}

}  // namespace

void OperatorControl::stop(const std::string& who) {
  end_all(OperatorCommand::Kind::Stop, who);
}

void OperatorControl::laser_off(const std::string& who) {
  end_all(OperatorCommand::Kind::LaserOff, who);
}

void OperatorControl::end_all(OperatorCommand::Kind kind, const std::string& who) {
  // The deed: all that follows tells of it.
  stops_.stop();
  const std::lock_guard lock{mutex_};
  if (cycle_.on_demand()) cycle_.give_up();
  cycle_.forget_part();
  if (cell_.shoe() == Shoe::Held) ended_ = shoe_scan_;
  cell_.on(CellEvent::Stop);
  stopped_by_ = who;
  command_locked({.kind = kind, .who = who});
}

void OperatorControl::taken_at_the_pendant() {
  const std::string who = "somebody at the pendant";
  if (has_doors()) {
    end_all(OperatorCommand::Kind::Stop, who);
  } else {
    stops_.stop();
    const std::lock_guard lock{mutex_};
    go_ = stops_.now();
    command_locked({.kind = OperatorCommand::Kind::Stop, .who = who});
  }
  const Result<void> logged = memory_.log({.id = 0,
                                           .time = memory::now_ms(),
                                           .who = who,
                                           .door = "pendant",
                                           .action = "stop",
                                           .subject = "cell",
                                           .before = {},
                                           .after = "local control"});
  if (!logged) log_error(logged.error());
}

Result<void> OperatorControl::start(const api::Job& job, const api::Speaker& said) {
  const robot::StopMark mark = stops_.at(said.stops);
  const std::string& who = said.name;
  if (mark.stopped()) return over();
  if (job.hold) BITELINE_TRY(keep_hold(true, who));
  const Result<void> begun = [&]() -> Result<void> {
    const std::lock_guard lock{mutex_};
    if (mark.stopped()) return over();
    if (cell_.shoe() == Shoe::Held)
      return fail(Errc::WrongState, "%s waits for a person; accept or reject it first", shoe_scan_.c_str());
    if (cell_.goes_on())
      return fail(Errc::WrongState, "%s is in work; start when it waits again, or is done",
                  shoe_scan_.c_str());
    if (cycle_.on_demand() && cycle_.busy())
      return fail(Errc::WrongState, "a scan is in work, and each start is one scan; wait for its end");
    api::Job said = job;
    said.part = cycle_.begin(0, job.part);
    hold_all_locked(job.hold);
    go_locked({.kind = OperatorCommand::Kind::Start, .who = who, .job = std::move(said), .mark = mark});
    return {};
  }();
  if (!begun) {
    keep_what_holds(who);
    return begun;
  }
  // Where it cannot be kept a restart holds on: that is the safe side.
  if (!job.hold) static_cast<void>(keep_hold(false, who));
  return {};
}

Result<void> OperatorControl::keep_hold(bool hold, const std::string& who) {
  {
    const std::lock_guard lock{mutex_};
    if (hold_kept_ == hold) return {};
  }
  BITELINE_TRY(memory_.put_setting(k_hold_key, hold ? "yes" : "no",
                                   {.id = 0,
                                    .time = memory::now_ms(),
                                    .who = who,
                                    .door = {},
                                    .action = hold ? "hold every scan" : "hold no more",
                                    .subject = "cell",
                                    .before = hold ? "no" : "yes",
                                    .after = hold ? "yes" : "no"}));
  const std::lock_guard lock{mutex_};
  hold_kept_ = hold;
  return {};
}

void OperatorControl::keep_what_holds(const std::string& who) {
  bool hold = false;
  {
    const std::lock_guard lock{mutex_};
    hold = hold_all_;
  }
  // Where it cannot be kept a restart holds: that is the safe side.
  static_cast<void>(keep_hold(hold, who));
}

void OperatorControl::hold_all_locked(bool hold) {
  if (hold_all_ && !hold) {
    if (std::string working = working_locked(); !working.empty()) hold_wanted_ = std::move(working);
  }
  hold_all_ = hold;
}

void OperatorControl::go_locked(OperatorCommand command) {
  go_ = command.mark;
  cell_.on(CellEvent::Start);
  ended_.clear();
  command_locked(std::move(command));
}

Result<void> OperatorControl::rescan(const Rescan& order) {
  const robot::StopMark mark = stops_.at(order.stops);
  std::string held;
  {
    const std::lock_guard lock{mutex_};
    if (mark.stopped()) return over();
    if (cell_.arm_will_move()) return fail(Errc::WrongState, "the arm follows a path; stop it first");
    if (cell_.goes_on())
      return fail(Errc::WrongState, "%s is in work; scan again when it waits again, or is done",
                  shoe_scan_.c_str());
    if (cell_.shoe() == Shoe::Held) held = shoe_scan_;
    if (held.empty() && cycle_.on_demand() && cycle_.busy())
      return fail(Errc::WrongState, "a scan is in work; wait for its end, or stop it first");
  }
  if (order.hold) BITELINE_TRY(keep_hold(true, order.who));
  if (!held.empty()) {
    const Result<void> rejected = decide({.kind = api::Decision::Kind::Reject,
                                          .scan = held,
                                          .who = order.who,
                                          .why = "scanned again: " + order.why,
                                          .door = order.door,
                                          .stops = order.stops});
    if (!rejected) {
      keep_what_holds(order.who);
      return rejected;
    }
  }
  const bool begun = [&] {
    const std::lock_guard lock{mutex_};
    if (mark.stopped()) return false;
    cycle_.begin_again();
    hold_all_locked(order.hold);
    go_locked({.kind = OperatorCommand::Kind::Rescan, .who = order.who, .why = order.why, .mark = mark});
    return true;
  }();
  if (!begun) {
    keep_what_holds(order.who);
    return over();
  }
  if (!order.hold) static_cast<void>(keep_hold(false, order.who));
  return {};
}

Result<void> OperatorControl::decide(const api::Decision& decision) {
  using enum api::Decision::Kind;
  const std::unique_lock words = between_words();
  bool held = false;
  bool in_work = false;
  bool ended = false;
  std::optional<report::ToldRefusal> why_not;
  const robot::StopMark mark = stops_.at(decision.stops);
  {
    const std::lock_guard lock{mutex_};
    const bool moves = decision.kind == Accept || decision.kind == Send;
    if (moves && mark.stopped() && ended_ != decision.scan) return over();
    if (mending_ == decision.scan)
      return fail(Errc::WrongState, "%s is being mended; decide when its path is checked", mending_.c_str());
    // A no would meet a path that is planned or run: stop it, or wait until it is held again.
    if (decision.kind == Reject && goes_on_locked(decision.scan))
      return fail(Errc::WrongState, "%s is in work; reject it when it waits again", shoe_scan_.c_str());
    // Whoever says no would believe that the arm stands.
    if (decision.kind == Reject && follows_locked(decision.scan))
      return fail(Errc::WrongState, "the arm follows %s; stop it (POST /commands/stop)",
                  decision.scan.c_str());
    held = holds_locked(decision.scan);
    ended = ended_ == decision.scan;
    if (held) why_not = not_sendable_locked();
    if (held && !decision.version.empty() && decision.version != version_)
      return fail(Errc::WrongState,
                  "%s is another version by now than the one that was looked at; look again",
                  decision.scan.c_str());
    in_work = !held && hold_wanted_ == decision.scan;
    if (decision.kind == Hold && !held && past_hold_ == decision.scan)
      return fail(Errc::WrongState, "it is too late to hold %s; stop the arm (POST /commands/stop)",
                  decision.scan.c_str());
    if (decision.kind == Hold && !held && in_work_locked(decision.scan)) {
      hold_wanted_ = decision.scan;
    } else if (decision.kind == Hold && !held) {
      return fail(Errc::WrongState, "%s is not in work any more; nothing is left to hold",
                  decision.scan.c_str());
    }
  }
  BITELINE_ASSIGN(std::optional<memory::Scan> scan, memory_.scan(decision.scan));
  if (!scan) {
    // In work: it has no row yet.
    if (decision.kind != Hold)
      return fail(Errc::FileNotFound, "%s among the finished scans", decision.scan.c_str());
    scan.emplace();
    scan->name = decision.scan;
    scan->time = memory::now_ms();
    scan->verdict = "working";
  }
  const bool sends = decision.kind == Accept || decision.kind == Send;
  const bool was_stopped = ended || scan->reason_code == report::refusal_row(robot::Refused::Stopped).name;
  if (sends && !held && was_stopped)
    return fail(Errc::WrongState, "%s was stopped and waits no longer; start, then scan the shoe again",
                decision.scan.c_str());
  if (sends && why_not)
    return fail(Errc::WrongState, "%s; %s", why_not->reason.c_str(), why_not->next_step.c_str());
  if (sends && !held)
    return fail(Errc::WrongState, "%s does not wait for a word; scan the shoe again", decision.scan.c_str());
  if (sends) BITELINE_TRY(look_at_files(decision.scan));
  // It would wait for a word all the same, as nobody tells the result's thread.
  if (decision.kind == Reject && in_work && scan->verdict == "working")
    return fail(Errc::WrongState, "%s is in work; reject it when it waits for a word", decision.scan.c_str());
  if (decision.kind == Reject && scan->sent)
    return fail(Errc::WrongState, "%s was sent already", decision.scan.c_str());
  if (decision.kind == Reject && scan->decision == "accepted")
    return fail(Errc::WrongState, "%s was accepted; stop the arm (POST /commands/stop)",
                decision.scan.c_str());
  if (decision.kind == Reject && scan->decision == "rejected")
    return fail(Errc::WrongState, "%s was rejected already", decision.scan.c_str());
  const std::string before = scan->decision;
  scan->decision = sends ? "accepted" : decision.kind == Reject ? "rejected" : "held";
  scan->decided_by = decision.who;
  scan->decided_at = memory::now_ms();
  scan->why = decision.why;
  BITELINE_TRY(memory_.put_scan(*scan, {.id = 0,
                                        .time = *scan->decided_at,
                                        .who = decision.who,
                                        .door = decision.door,
                                        .action = scan->decision,
                                        .subject = decision.scan,
                                        .before = before,
                                        .after = decision.why}));
  if (held && decision.kind != Hold) {
    {
      const std::lock_guard lock{mutex_};
      // A stop that came meanwhile has ended it: the word's mark says so to whoever heeds it.
      cell_.on(sends ? CellEvent::Accept : CellEvent::Reject);
      // At once: a start that comes after the no is a person's word to go on.
      if (!sends && held_is_step_) cell_.on(CellEvent::AsksPerson);
      hold_wanted_.clear();
    }
    if (!sends) end_cycle(*scan);
    command({.kind = sends ? OperatorCommand::Kind::Send : OperatorCommand::Kind::Reject,
             .scan = decision.scan,
             .who = decision.who,
             .why = decision.why,
             .mark = mark});
  }
  tell_scan(decision.scan);
  return {};
}

Result<void> OperatorControl::look_at_files(const std::string& scan) const {
  BITELINE_ASSIGN(const std::optional<memory::Evidence> written, memory_.evidence(scan));
  if (!written) return {};
  BITELINE_ASSIGN(const memory::Evidence now, evidence::of_folder(config_.results / scan));
  if (const auto changed = evidence::change(*written, now))
    return fail(Errc::WrongState, "%s: %s", scan.c_str(), changed->c_str());
  return {};
}

Result<void> OperatorControl::choose_model(const std::string& scan, const std::string& model,
                                           const api::Speaker& who) {
  const std::unique_lock words = between_words();
  const robot::StopMark mark = stops_.at(who.stops);
  {
    const std::lock_guard lock{mutex_};
    if (mark.stopped()) return over();
    if (!holds_locked(scan) || waits_ != Waits::ForModel)
      return fail(Errc::WrongState, "%s does not wait for its model", scan.c_str());
    // Whoever wants to see it first still does, also once its model is named.
    cell_.on(CellEvent::Plan);
  }
  command({.kind = OperatorCommand::Kind::Model,
           .scan = scan,
           .who = who.name,
           .why = {},
           .job = {.model = model, .process = {}},
           .mark = mark});
  return {};
}

bool OperatorControl::holds_locked(const std::string& scan) const {
  return cell_.shoe() == Shoe::Held && shoe_scan_ == scan;
}

bool OperatorControl::goes_on_locked(const std::string& scan) const {
  return cell_.goes_on() && shoe_scan_ == scan;
}

std::string OperatorControl::working_locked() const {
  if (cell_.shoe() == Shoe::Working || cell_.shoe() == Shoe::Planning) return shoe_scan_;
  return cell_.shoe() == Shoe::None && cell_.sensing() == Sensing::Scanning ? scan_ : std::string{};
}

bool OperatorControl::in_work_locked(const std::string& scan) const {
  return working_locked() == scan || (cell_.sensing() == Sensing::Scanning && scan_ == scan);
}

bool OperatorControl::follows_locked(const std::string& scan) const {
  return cell_.arm_will_move() && shoe_scan_ == scan;
}

Result<void> OperatorControl::take_held_locked(const std::string& scan, const robot::StopMark& mark,
                                               CellEvent event) {
  if (mark.stopped()) return over();
  if (!config_.rerun_arm)
    return fail(Errc::WrongState, "no path is planned without an arm; start the service with --robot");
  if (mending_ == scan) return fail(Errc::WrongState, "%s is being mended; wait for it", mending_.c_str());
  if (!holds_locked(scan))
    return fail(Errc::WrongState, "%s does not wait for a person; scan the shoe again, and hold it",
                scan.c_str());
  cell_.on(event);
  return {};
}

Result<void> OperatorControl::choose_process(const std::string& scan, const std::string& process,
                                             const api::Speaker& who) {
  const std::unique_lock words = between_words();
  const robot::StopMark mark = stops_.at(who.stops);
  {
    const std::lock_guard lock{mutex_};
    BITELINE_TRY(take_held_locked(scan, mark, CellEvent::Plan));
  }
  command({.kind = OperatorCommand::Kind::Process,
           .scan = scan,
           .who = who.name,
           .why = {},
           .job = {.model = {}, .process = process},
           .mark = mark});
  return {};
}

void OperatorControl::model_saved(const std::string& process_sha256, const std::string& who) {
  command({.kind = OperatorCommand::Kind::Saved, .scan = {}, .who = who, .why = process_sha256});
}

Result<void> OperatorControl::run_in_air(const std::string& scan, const api::Speaker& who) {
  const std::unique_lock words = between_words();
  const robot::StopMark mark = stops_.at(who.stops);
  {
    const std::lock_guard lock{mutex_};
    if (holds_locked(scan) && waits_ != Waits::ForWord)
      return fail(Errc::WrongState, "%s has no checked path yet; choose its process, or its model",
                  scan.c_str());
    BITELINE_TRY(take_held_locked(scan, mark, CellEvent::Plan));
  }
  command({.kind = OperatorCommand::Kind::Air, .scan = scan, .who = who.name, .why = {}, .mark = mark});
  return {};
}

Result<void> OperatorControl::look_again(const std::string& scan, const api::Speaker& who) {
  const std::unique_lock words = between_words();
  const robot::StopMark mark = stops_.at(who.stops);
  {
    const std::lock_guard lock{mutex_};
    if (holds_locked(scan) && waits_ != Waits::ForWord)
      return fail(Errc::WrongState, "%s has no checked path yet; there is nothing to keep fresh",
                  scan.c_str());
    if (cell_.sensing() != Sensing::Idle)
      return fail(Errc::WrongState, "the sensor is not free to look; wait for it");
    BITELINE_TRY(take_held_locked(scan, mark, CellEvent::Look));
  }
  command({.kind = OperatorCommand::Kind::Look, .scan = scan, .who = who.name, .why = {}, .mark = mark});
  return {};
}

Result<void> OperatorControl::begin_mend(const std::string& scan) {
  const std::unique_lock words = between_words();
  const std::lock_guard lock{mutex_};
  if (holds_locked(scan) && waits_ == Waits::ForModel)
    return fail(Errc::WrongState, "the model of %s is not known; choose one first", scan.c_str());
  if (!mending_.empty()) return fail(Errc::WrongState, "%s is being mended; wait for it", mending_.c_str());
  // Also while another scan comes in.
  if (goes_on_locked(scan))
    return fail(Errc::WrongState, "%s is in work; mend it when it waits again", scan.c_str());
  if (in_work_locked(scan) || follows_locked(scan))
    return fail(Errc::WrongState, "%s is in work; mend it when it is done", scan.c_str());
  mending_ = scan;
  return {};
}

void OperatorControl::end_mend(const std::string& scan, bool mended, const api::Speaker& who) {
  {
    const std::lock_guard lock{mutex_};
    if (!mended || !holds_locked(scan)) {
      mending_.clear();
      return;
    }
    // What waits gets its path planned anew; until then nobody can accept it.
    cell_.on(CellEvent::Plan);
  }
  command({.kind = OperatorCommand::Kind::Mended,
           .scan = scan,
           .who = who.name,
           .why = {},
           .mark = stops_.at(who.stops)});
}

Result<int> OperatorControl::rerun(const api::RerunOrder& order) {
  {
    const std::lock_guard lock{mutex_};
    if (in_work_locked(order.scan) && !goes_on_locked(order.scan))
      return fail(Errc::WrongState, "%s is in work; wait for its result", order.scan.c_str());
  }
  return reruns_->add(order);
}

Result<api::TriedPath> OperatorControl::try_process(const std::string& scan, const path::Process& process) {
  if (!config_.rerun_arm)
    return fail(Errc::WrongState, "no path is planned without an arm; start the service with --robot");
  {
    const std::lock_guard lock{mutex_};
    if (cell_.arm_will_move())
      return fail(Errc::WrongState, "the arm follows a path; try again when it stands");
  }
  BITELINE_ASSIGN(const path::PlanOutcome outcome, try_path(reruns_->room(), scan, process));
  if (outcome.path) return api::TriedPath{.refused = {}, .duration_s = outcome.path->duration_s()};
  return api::TriedPath{.refused = report::told(*outcome.refusal), .duration_s = 0};
}

Result<robot::ur::ArmLook> OperatorControl::look_at_arm() {
  if (config_.rtde.empty() && !config_.other)
    return fail(
        Errc::WrongState,
        "there is no arm to touch with; start the service with --robot, with --arm-link and --send too");
  {
    const std::lock_guard lock{mutex_};
    if (cell_.arm_will_move()) return fail(Errc::WrongState, "the arm follows a path; touch when it stands");
  }
  if (config_.other) return robot::ur::look_at_arm(*config_.other);
  BITELINE_ASSIGN(const HostPort rtde, parse_host_port(config_.rtde));
  return robot::ur::look_at_arm(rtde.host, rtde.port);
}

bool OperatorControl::rerun_open(const std::string& scan, int number) {
  return reruns_->open(scan, number);
}

}  // namespace biteline::service
