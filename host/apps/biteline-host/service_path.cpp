// SPDX-License-Identifier: MIT
// A line becomes a path and a motion, at once or after a person's word.
#include <utility>

#include "host/apps/biteline-host/scan_row.hpp"
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/doors/api/air.hpp"
#include "host/records/evidence/evidence.hpp"
#include "host/records/mounted/mounted_record.hpp"
#include "host/records/results/plan_result.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

}  // namespace

bool Service::holds_arm() const {
  return locks_.arm && (!locks_.claim || locks_.claim->safe());
}

Result<path::Mounted> Service::mounted() const {
  BITELINE_ASSIGN(const mounted::Record record, mounted::read_record(cockpit_->memory()));
  return record.mounted();
}

Result<ExitStatus> Service::work_out_path(Scan& scan, const intake::ScanOutcome& outcome, LineStep& line,
                                          bool held) {
  const std::string name = scan.folder.filename().string();
  BITELINE_ASSIGN(const path::Mounted taught, mounted());
  ArmSeen arm = scan.arm_seen.valid() ? scan.arm_seen.get() : ArmSeen{.arm = robot_->arm};
  if (arm.T_flange_tcp) say_tool_difference(process_of(scan.chosen), *arm.T_flange_tcp);
  const PlanStepRequest request{.arm = std::move(arm.arm),
                                .process = process_of(scan.chosen),
                                .table_z_mm = robot_->options.table_z_mm,
                                .fixture = fixture_of(robot_->options),
                                .mounted = taught,
                                .near_rad = arm.q_rad};
  cockpit_->show(Phase::Working, "plans the path of " + name,
                 robot_->options.send ? "the arm follows it" : "the next scan");
  // Who stops has to know before the arm sets out; who warns does not keep it waiting.
  if (options_.stop_on_drift) look_at_own_calibration(scan, outcome);
  BITELINE_TRY(keep_process(scan.folder, scan.chosen));
  BITELINE_ASSIGN(scan.chosen.written, evidence::of_folder(scan.folder));
  scan.chosen.written.process = taken_of(scan.chosen).sha256;
  scan.chosen.written.report.clear();  // it is not the last one yet
  BITELINE_ASSIGN(PlanStep plan, plan_path(scan.folder / "path", request, outcome, *line.line));
  const bool wanted = plan.outcome.path && robot_->options.send;
  robot::ScanFacts facts = facts_of(scan, outcome);
  facts.pictures_vouched = line.pictures_vouched;
  SendRequest send{.controller = controller_of(robot_->options),
                   .serial = robot_->options.serial,
                   .holds_arm = holds_arm(),
                   .scan = facts,
                   .confidence = line.confidence,
                   .approved = {},
                   .scan_ended = scan.recovered ? std::nullopt : scan.ended,
                   .mounted = taught,
                   .mark = scan.mark,
                   .claim = locks_.claim.get(),
                   .pendant = pendant_.get(),
                   .looked_at = scan.folder,
                   .written = scan.chosen.written,
                   .process_file = taken_of(scan.chosen).file};
  if (options_.stop_on_drift) check_own_calibration(scan, outcome);
  const bool drift_stops = scan.drifted && options_.stop_on_drift;
  look_at_part(scan.chosen, scan.folder);
  // Nobody asked for a person, and yet one has to look.
  std::string looks = scan.chosen.other_process;
  if (!scan.chosen.told_twice.empty()) looks += (looks.empty() ? "" : "; ") + scan.chosen.told_twice;
  if (scan.chosen.foot.empty() && path::needs_foot(taken_of(scan.chosen).process))
    looks += std::string{looks.empty() ? "" : "; "} + "the process has stretches of a " +
             taken_of(scan.chosen).process.foot + " shoe, and nobody knows this one's foot";
  const bool must =
      needs_a_person(process_of(scan.chosen).gate, line.confidence) || drift_stops || !looks.empty();
  const bool goes = wanted && !must;
  const bool hold =
      (goes ? cockpit_->wants_hold_at_last(name) : cockpit_->wants_hold(name)) || !looks.empty();
  const bool asks = must || hold;
  const bool waits_for_person = wanted && asks && !facts.confirmed && cockpit_->has_doors();
  if (waits_for_person || (held && robot_->options.send)) {
    say_step("%s is held: a person must %s%s%s", name.c_str(),
             line.status == ExitStatus::Review ? "settle its line" : "accept it", looks.empty() ? "" : ": ",
             looks.c_str());
    held_.emplace(Held{.folder = scan.folder,
                       .intake = std::move(scan.intake),
                       .plan = std::move(plan),
                       .request = std::move(send),
                       .chosen = scan.chosen});
    return ExitStatus::Done;
  }
  // What a person may still say yes to stays whole.
  const bool seen = !facts.recovered && !facts.from_recording && facts.one_connection;
  const bool waits_for_a_word = wanted && !facts.confirmed && (!seen || asks);
  if (!waits_for_a_word) end_recording(scan.intake, plan.status);
  if (!wanted) return plan.status;
  if (drift_stops && !facts.confirmed) {
    say_step(
        "refused: the path of %s is not sent: the calibration has drifted, or could not be checked; a person "
        "who has looked may say --confirm %s",
        name.c_str(), name.c_str());
    return ExitStatus::Refused;
  }
  if (!looks.empty() && !facts.confirmed) {
    say_step("refused: the path of %s is not sent: %s; a person who has looked may say --confirm %s",
             name.c_str(), looks.c_str(), name.c_str());
    return ExitStatus::Refused;
  }
  if (hold && !facts.confirmed) {
    // Of a service before this one, that had doors.
    say_step(
        "refused: the path of %s is not sent: every scan waits for a person, and no door is open; start "
        "without hold at a door (--control), or say --confirm %s",
        name.c_str(), name.c_str());
    return ExitStatus::Refused;
  }
  cockpit_->show(Phase::Following, "the arm follows the line of " + name, "the next scan");
  BITELINE_ASSIGN(send.mounted, mounted());
  look_at_own_calibration(scan, outcome);
  return follow_path(scan.folder, plan, send, [&] { return line.pages.write(outcome.cloud); });
}

Result<void> Service::look_at_files(Held& held) {
  const std::string name = held.folder.filename().string();
  // The newest, also of a mend in the page.
  BITELINE_ASSIGN(const std::optional<memory::Evidence> kept, cockpit_->memory().evidence(name));
  memory::Evidence written = kept.value_or(held.chosen.written);
  written.process = taken_of(held.chosen).sha256;
  BITELINE_ASSIGN(const memory::Evidence now, evidence::of_folder(held.folder));
  if (const auto changed = evidence::change(written, now))
    return fail(Errc::WrongState, "%s: %s", name.c_str(), changed->c_str());
  held.chosen.written = held.request.written = written;
  held.request.process_file = taken_of(held.chosen).file;
  return {};
}

Result<ExitStatus> Service::plan_anew(Held& held) {
  // From here on the old path is none: its folder is written anew.
  held.plan.outcome = {};
  // Nor has the new one run in the air.
  std::error_code error;
  fs::remove_all(held.folder / api::k_air_folder, error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", held.folder.c_str());
  BITELINE_TRY(results::prepare_plan_folder(held.folder / "path"));
  BITELINE_TRY(look_at_files(held));
  const std::optional<memory::Scan> row = row_of(held.folder);
  if (!row || row->verdict == "refused") return ExitStatus::Refused;
  if (row->verdict == "review") return ExitStatus::Review;
  held.request.confidence = row->confidence.value_or(0);
  BITELINE_ASSIGN(cloud::ClosedLine line, cloud::read_line(held.folder / "line.csv"));
  BITELINE_ASSIGN(held.plan.request.mounted, mounted());
  held.plan.request.table_z_mm = held.plan.request.mounted.table_z_mm.value_or(robot_->options.table_z_mm);
  BITELINE_ASSIGN(held.plan, plan_again(held.folder / "path", held.plan.request, std::move(line)));
  return held.plan.status;
}

Result<ExitStatus> Service::plan_mended(Held held) {
  const std::string name = held.folder.filename().string();
  cockpit_->show(Phase::Working, "plans the path of the mended " + name, "a person decides");
  const Result<ExitStatus> status = without_exceptions([&] { return plan_anew(held); });
  // Also without a path: it can be mended again, or rejected.
  held_.emplace(std::move(held));
  remember(held_->folder, "held", held_->chosen, {});
  return status;
}

Result<ExitStatus> Service::send_held(Held held, const robot::Word& word) {
  cockpit_->show(Phase::Following, "the arm follows the line of " + held.folder.filename().string(),
                 "the next scan");
  held.request.approved = word;
  held.request.holds_arm = holds_arm();
  const Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    BITELINE_ASSIGN(held.request.mounted, mounted());
    return follow_path(held.folder, held.plan, held.request);
  });
  if (!was_sent(held.folder) && held.request.mark.stopped()) {
    end_recording(held.intake, ExitStatus::Refused);
    remember(held.folder, "open", held.chosen, {.stopped = true});
    return status;
  }
  if (!was_sent(held.folder)) {
    // A yes that came to nothing starts nothing else: neither light nor the next scan.
    const std::string failed = status ? std::string{} : to_line(status.error());
    say_step("%s is held: nothing was sent", held.folder.filename().c_str());
    held_.emplace(std::move(held));
    remember(held_->folder, "held", held_->chosen, {.failed = failed});
    return status;
  }
  end_recording(held.intake, ExitStatus::Done);
  remember(held.folder, "accepted", held.chosen, {});
  return status;
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
