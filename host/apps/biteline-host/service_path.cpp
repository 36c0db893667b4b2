// SPDX-License-Identifier: MIT
// A line becomes a path and a motion, at once or after a person's word.
#include <algorithm>
#include <utility>

#include "host/apps/biteline-host/next_of.hpp"
#include "host/apps/biteline-host/scan_row.hpp"
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/interfaces/api/air.hpp"
#include "host/records/evidence/evidence.hpp"
#include "host/records/mounted/mounted_record.hpp"
#include "host/records/results/plan_result.hpp"
#include "host/robot/link/ur/tool_changer.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

}  // namespace

bool Service::holds_arm() const {
  return locks_.arm && (!locks_.claim || locks_.claim->safe()) &&
         (!locks_.other || locks_.other->status().connected);
}

ControllerAddress Service::controller() const {
  ControllerAddress controller = controller_of(robot_->options);
  controller.other = locks_.other;
  return controller;
}

Result<path::Mounted> Service::mounted(const path::Process& process) const {
  BITELINE_ASSIGN(const mounted::Record record, mounted::read_record(operator_control_->memory()));
  path::Mounted mounted = record.mounted(process.tool.name);
  // Lines of a Universal Robots' controller: the generic protocol has none.
  if (locks_.other) mounted.changer.reset();
  return mounted;
}

void Service::keep_tool_that_stands(const std::optional<std::string>& name) const {
  memory::Memory& memory = operator_control_->memory();
  const mounted::Hand hand{.who = "changer", .door = "controller"};
  const auto keep = [&]() -> Result<void> {
    BITELINE_ASSIGN(const mounted::Record record, mounted::read_record(memory));
    const std::string before = record.tool ? record.tool->name : std::string{};
    if (before == name.value_or("")) return {};
    if (name) return mounted::mount_tool(memory, *name, hand).map([](const auto&) {});
    return mounted::forget(memory, mounted::Part::Tool, hand).map([](const auto&) {});
  };
  if (const Result<void> kept = keep(); !kept) log_error(kept.error());
  operator_control_->tool_mounted();
}

void Service::make_room_for(const path::Process& next, path::Process& process) const {
  const Result<path::Mounted> taught = mounted(next);
  // What cannot be read stops the next process, and not this one.
  if (!taught) return log_error(taught.error());
  if (!taught->changer || next.tool.name == process.tool.name) return;
  process.motion.lift_mm =
      std::max(process.motion.lift_mm, robot::ur::room_to_change_mm(*taught->changer, next.tool));
}

SendRequest Service::send_request(const Scan& scan, const intake::ScanOutcome& outcome, const LineStep& line,
                                  const path::Mounted& taught) const {
  robot::ScanFacts facts = facts_of(scan, outcome);
  facts.pictures_vouched = line.pictures_vouched;
  return {.controller = controller(),
          .serial = robot_->options.serial,
          .holds_arm = holds_arm(),
          .scan = facts,
          .confidence = line.confidence,
          .approved = {},
          .scan_ended = scan.recovered ? std::nullopt : scan.ended,
          .mounted = taught,
          .tool_stands = [this](const std::optional<std::string>& name) { keep_tool_that_stands(name); },
          .mark = scan.mark,
          .claim = locks_.claim.get(),
          .pendant = pendant_.get(),
          .clamp = clamp_.get(),
          .looked_at = scan.folder,
          .written = scan.chosen.written,
          .process_file = taken_of(scan.chosen).file};
}

std::string Service::looks_of(const Chosen& chosen, const path::Mounted& mounted) const {
  std::string looks;
  const auto add = [&looks](const std::string& why) {
    if (!why.empty()) looks += (looks.empty() ? "" : "; ") + why;
  };
  add(chosen.other_process);
  add(chosen.told_twice);
  const path::Process& process = taken_of(chosen).process;
  if (chosen.foot.empty() && path::needs_foot(process))
    add("the process has stretches of a " + process.foot + " shoe, and nobody knows this one's foot");
  if (path::waits_for_its_tool(process, mounted))
    add("the tool " + process.tool.name + " is to be mounted; " +
        (mounted.tool ? *mounted.tool + " is" : "nobody has said which one is"));
  return looks;
}

Result<Service::WorkedOut> Service::work_out_path(Scan& scan, const intake::ScanOutcome& outcome,
                                                  LineStep& line, bool waits) {
  const std::string name = scan.folder.filename().string();
  BITELINE_TRY(take_following(scan.chosen));
  BITELINE_ASSIGN(const path::Mounted taught, mounted(process_of(scan.chosen)));
  ArmSeen arm = scan.arm_seen.valid() ? scan.arm_seen.get() : ArmSeen{.arm = robot_->arm};
  if (arm.T_flange_tcp) say_tool_difference(process_of(scan.chosen), *arm.T_flange_tcp);
  const PlanStepRequest request{.arm = std::move(arm.arm),
                                .process = process_to_plan(scan.chosen),
                                .table_z_mm = robot_->options.table_z_mm,
                                .fixture = fixture_of(robot_->options),
                                .mounted = taught,
                                .near_rad = arm.q_rad};
  operator_control_->show("plans the path of " + name,
                          robot_->options.send ? "the arm follows it" : "the next scan");
  // Who stops has to know before the arm sets out; who warns does not keep it waiting.
  if (options_.stop_on_drift) look_at_own_calibration(scan, outcome);
  BITELINE_TRY(keep_process(scan.folder, scan.chosen));
  BITELINE_ASSIGN(scan.chosen.written, evidence::of_folder(scan.folder));
  scan.chosen.written.process = taken_of(scan.chosen).sha256;
  scan.chosen.written.report.clear();  // it is not the last one yet
  BITELINE_ASSIGN(PlanStep plan, plan_path(scan.folder / "path", request, outcome, *line.line));
  SendRequest send = send_request(scan, outcome, line, taught);
  if (options_.stop_on_drift) check_own_calibration(scan, outcome);
  look_at_part(scan.chosen, scan.folder);

  const robot::ScanFacts& seen = send.scan;
  NextFacts facts{.sends = robot_->options.send,
                  .has_path = plan.outcome.path.has_value(),
                  .doors = operator_control_->has_doors(),
                  .waits = waits,
                  .confirmed = seen.confirmed.has_value(),
                  .seen = !seen.recovered && !seen.from_recording && seen.one_connection,
                  .asks_by_gate = needs_a_person(process_of(scan.chosen).gate, line.confidence),
                  .asked_to_hold = operator_control_->wants_hold(name),
                  .drift_stops = scan.drifted && options_.stop_on_drift,
                  .looks = looks_of(scan.chosen, taught)};
  NextStep step = next_of(facts);
  // The last look: from now on whoever wants it held is told that it is too late.
  if (step.next == Next::Send && operator_control_->wants_hold_at_last(name)) {
    facts.asked_to_hold = true;
    step = next_of(facts);
  }
  if (!step.keeps_recording) end_recording(scan.intake, plan.status);
  switch (step.next) {
    case Next::Keep:
      return WorkedOut{.status = plan.status};
    case Next::Refuse:
      warn_step("refused: the path of %s is not sent: %s; a person who has looked may say --confirm %s",
                name.c_str(), step.why.c_str(), name.c_str());
      return WorkedOut{.status = ExitStatus::Refused};
    case Next::Hold:
      log_step("%s is held: a person must %s%s%s", name.c_str(),
               line.status == ExitStatus::Review ? "settle its line" : "accept it",
               facts.looks.empty() ? "" : ": ", facts.looks.c_str());
      return WorkedOut{
          .status = ExitStatus::Done,
          .held = HeldScan{.scan = std::move(scan),
                           .what = Planned{.plan = std::move(plan), .request = std::move(send)}}};
    case Next::Send:
      break;
  }
  operator_control_->enter(CellEvent::ArmSetsOut);
  operator_control_->show("the arm follows the line of " + name, "the next scan");
  BITELINE_ASSIGN(send.mounted, mounted(plan.request.process));
  look_at_own_calibration(scan, outcome);
  BITELINE_ASSIGN(
      const ExitStatus status, follow_and_owe_look(scan.folder, scan.chosen, [&] {
        return follow_path(
            scan.folder, plan, send, [&] { return line.pages.write(outcome.cloud); },
            [&](const path::ForceTold& told) { learn_force(scan.chosen, name, plan.request.process, told); });
      }));
  WorkedOut out{.status = status};
  if (status == ExitStatus::Done && goes_on_after(scan.chosen))
    out.after =
        AfterWork{.scan = std::move(scan), .planned = {.plan = std::move(plan), .request = std::move(send)}};
  return out;
}

Result<void> Service::look_at_files(HeldScan& held) {
  const std::string name = held.name();
  Chosen& chosen = held.scan.chosen;
  // The newest, also of a mend in the page.
  BITELINE_ASSIGN(const std::optional<memory::Evidence> kept, operator_control_->memory().evidence(name));
  memory::Evidence written = kept.value_or(chosen.written);
  written.process = taken_of(chosen).sha256;
  BITELINE_ASSIGN(const memory::Evidence now, evidence::of_folder(held.scan.folder));
  if (const auto changed = evidence::change(written, now))
    return fail(Errc::WrongState, "%s: %s", name.c_str(), changed->c_str());
  chosen.written = held.planned()->request.written = written;
  held.planned()->request.process_file = taken_of(chosen).file;
  return {};
}

Result<ExitStatus> Service::plan_anew(HeldScan& held) {
  const fs::path& folder = held.scan.folder;
  if (held.scan.chosen.rework) {
    held.planned()->plan.outcome = {};
    return fail(Errc::WrongState,
                "%s works once more what a look has found missing along its own line; reject it",
                held.name().c_str());
  }
  PlanStep& plan = held.planned()->plan;
  // From here on the old path is none: its folder is written anew.
  plan.outcome = {};
  // Nor has the new one run in the air.
  std::error_code error;
  fs::remove_all(folder / api::k_air_folder, error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", folder.c_str());
  BITELINE_TRY(results::prepare_plan_folder(folder / "path"));
  BITELINE_TRY(look_at_files(held));
  const std::optional<memory::Scan> row = row_of(folder);
  if (!row || row->verdict == "refused") return ExitStatus::Refused;
  if (row->verdict == "review") return ExitStatus::Review;
  held.planned()->request.confidence = row->confidence.value_or(0);
  BITELINE_ASSIGN(cloud::ClosedLine line, cloud::read_line(folder / "line.csv"));
  BITELINE_ASSIGN(plan.request.mounted, mounted(plan.request.process));
  plan.request.table_z_mm = plan.request.mounted.table_z_mm.value_or(robot_->options.table_z_mm);
  BITELINE_ASSIGN(plan, plan_again(folder / "path", plan.request, std::move(line)));
  return plan.status;
}

Service::Worked Service::plan_mended(HeldScan held) {
  operator_control_->show("plans the path of the mended " + held.name(), "a person decides");
  Result<ExitStatus> status = without_exceptions([&] { return plan_anew(held); });
  // Also without a path: it can be mended again, or rejected.
  return hold_again(std::move(status), std::move(held));
}

Service::Worked Service::send_held(HeldScan held, const robot::Word& word) {
  const fs::path& folder = held.scan.folder;
  Planned& planned = *held.planned();
  operator_control_->enter(CellEvent::ArmSetsOut);
  operator_control_->show("the arm follows the line of " + held.name(), "the next scan");
  planned.request.approved = word;
  planned.request.holds_arm = holds_arm();
  Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    BITELINE_ASSIGN(planned.request.mounted, mounted(planned.plan.request.process));
    const auto learn = [&](const path::ForceTold& told) {
      learn_force(held.scan.chosen, held.name(), planned.plan.request.process, told);
    };
    return follow_and_owe_look(folder, held.scan.chosen,
                               [&] { return follow_path(folder, planned.plan, planned.request, {}, learn); });
  });
  if (was_sent(folder)) {
    end_recording(held.scan.intake, ExitStatus::Done);
    const Chosen& chosen = held.scan.chosen;
    const bool goes_on = status && *status == ExitStatus::Done && goes_on_after(chosen);
    const Remembered told = remember(folder, "accepted", chosen, {.goes_on = goes_on});
    const std::string cut = cut_off(folder, chosen, status);
    Worked worked{.status = std::move(status), .held = {}, .end = told.end};
    if (!cut.empty()) return ask_a_person(std::move(worked), cut);
    if (!goes_on) return worked;
    AfterWork after{.scan = std::move(held.scan), .planned = std::move(planned)};
    if (!looks_after(after.scan.chosen)) return begin_step(std::move(after));
    worked.after = std::move(after);
    return worked;
  }
  if (held.scan.mark.stopped()) {
    end_recording(held.scan.intake, ExitStatus::Refused);
    const Remembered told = remember(folder, "open", held.scan.chosen, {.stopped = true});
    return {.status = std::move(status), .held = {}, .end = told.end};
  }
  // A yes that came to nothing starts nothing else: neither light nor the next scan.
  log_step("%s is held: nothing was sent", held.name().c_str());
  const std::string failed = status ? std::string{} : to_line(status.error());
  return hold_again(std::move(status), std::move(held), failed);
}

robot::ScanFacts Service::facts_of(const Scan& scan, const intake::ScanOutcome& outcome) const {
  robot::ScanFacts facts{
      .name = scan.folder.filename().string(),
      .scan_id = scan.intake.scan_id(),
      .recovered = scan.recovered,
      .from_recording = outcome.sensor.lossless,
      .one_connection = scan.one_connection,
      .messages_lost = outcome.messages_lost,
      .lost = {
          .frames = outcome.lost.frames, .profiles = outcome.lost.profiles, .edges = outcome.lost.edges}};
  facts.confirmed = scan.confirmed;
  return facts;
}

}  // namespace biteline::service
