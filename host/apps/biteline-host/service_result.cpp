// SPDX-License-Identifier: MIT
// A complete scan becomes a line, a path and a motion.
#include <exception>
#include <utility>

#include "common/system/user_name.hpp"
#include "host/apps/biteline-host/arm_memory.hpp"
#include "host/apps/biteline-host/attempt.hpp"
#include "host/apps/biteline-host/calibration_check.hpp"
#include "host/apps/biteline-host/prior_step.hpp"
#include "host/apps/biteline-host/recognise.hpp"
#include "host/apps/biteline-host/scan_row.hpp"
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/doors/api/air.hpp"
#include "host/records/evidence/evidence.hpp"
#include "host/records/mounted/mounted_record.hpp"
#include "host/records/results/plan_result.hpp"
#include "host/transfer/library.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

std::string hash_of(const std::optional<release::InForce>& release) {
  return release ? release->hash : std::string{};
}

}  // namespace

Result<ExitStatus> Service::work_out(Scan scan) {
  const std::string name = scan.folder.filename().string();
  cockpit_->show(Phase::Working, "works out the line of " + name, robot_ ? "its path" : "the next scan");
  const fs::path folder = scan.folder;
  Result<ExitStatus> status = work_out_files(scan);
  close_result(folder, unnamed_ ? unnamed_->scan.chosen : scan.chosen);
  return status;
}

void Service::close_result(const fs::path& folder, Chosen chosen) {
  // From here on nobody but a mend writes them.
  if (const Result<memory::Evidence> now = evidence::of_folder(folder)) {
    if (chosen.written == memory::Evidence{}) chosen.written = *now;
    chosen.written.report = now->report;
    if (held_) held_->chosen.written = held_->request.written = chosen.written;
  } else {
    complain(now.error());
  }
  std::string decision = "open";
  if (waits()) {
    decision = "held";
  } else if (robot_ && process_of(chosen).gate.automatic_above) {
    decision = "automatic";
  }
  remember(folder, decision, chosen, {});
  if (const Result<void> room = make_room(); !room) complain(room.error());
}

Result<ExitStatus> Service::work_out_files(Scan& scan) {
  BITELINE_TRY(mark_attempt(scan.folder));
  intake::ScanOutcome outcome;
  LineStep line;
  const auto path_follows = [&] {
    return scan.chosen.unknown.empty() && line.line.has_value() && robot_.has_value();
  };
  Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    // Beside the line, so that the path waits for neither.
    if (robot_ && robot_->options.send)
      scan.arm_seen = std::async(std::launch::async, see_arm, controller_of(robot_->options), robot_->arm);
    BITELINE_ASSIGN(line, work_out_line(scan, outcome));
    if (!path_follows()) BITELINE_TRY(line.pages.write(outcome.cloud));
    return line.status;
  });
  if (status && !path_follows()) check_own_calibration(scan, outcome);
  if (!status) {
    // A disk that is full or a folder that is gone is not the scan's fault: it is taken up again.
    const bool own_fault = status.error().code != Errc::DiskFull && status.error().code != Errc::WriteFailed;
    if (!own_fault) clear_attempt(scan.folder);
    if (!own_fault || !set_aside(scan.folder, to_line(status.error()))) return status;
    return ExitStatus::Refused;
  }
  clear_attempt(scan.folder);
  if (!scan.chosen.unknown.empty()) {
    say_step("%s is held: its model is not known: %s", scan.folder.filename().c_str(),
             scan.chosen.unknown.c_str());
    unnamed_.emplace(
        Unnamed{.scan = std::move(scan), .outcome = std::move(outcome), .line = std::move(line)});
    return ExitStatus::Done;
  }
  if (!line.line || !robot_) {
    end_recording(scan.intake, *status);
    return status;
  }
  const bool review = line.status == ExitStatus::Review;
  status =
      without_exceptions([&] { return work_out_path(scan, outcome, line, review && cockpit_->has_doors()); });
  // No path is planned along it, and that is not why it ends.
  if (status && review && !held_) status = ExitStatus::Review;
  const Result<ExitStatus> pages = without_exceptions([&]() -> Result<ExitStatus> {
    BITELINE_TRY(line.pages.write(outcome.cloud));
    return ExitStatus::Done;
  });
  if (!pages) complain(pages.error());
  check_own_calibration(scan, outcome);
  return status;
}

Result<void> Service::choose_release(Chosen& chosen) const {
  if (options_.releases.empty()) return {};
  BITELINE_ASSIGN(chosen.release, release::in_force(options_.releases, memory::now_ms()));
  return {};
}

api::Stock Service::stock_for(const Chosen& chosen) const {
  return stock_of(chosen.release, stock_folders(options_));
}

Result<LineStep> Service::work_out_line(Scan& scan, intake::ScanOutcome& outcome) {
  outcome = scan.intake.finish();
  if (!scan.stopped_by.empty()) outcome.failure = stopped_on_its_way(scan.stopped_by);
  outcome.stopped_by = scan.stopped_by;
  BITELINE_TRY(choose_release(scan.chosen));
  const KnownBefore known = known_before();
  if (carrier_) {
    scan.chosen.model = carrier_->name;
    if (robot_) scan.chosen.process_name = robot_->process.process.name;
    BITELINE_ASSIGN(LineStep carried, carry_line(scan.folder, *carrier_, outcome, known, {}));
    keep_arm(scan, carried);
    return carried;
  }
  BITELINE_ASSIGN(LineStep found,
                  find_line(scan.folder, outcome, *scan.line, known, hash_of(scan.chosen.release)));
  keep_arm(scan, found);
  return use_library(scan, outcome, std::move(found));
}

KnownBefore Service::known_before() const {
  KnownBefore known{.head = options_.uncertainty, .arm = {}};
  if (const auto arm = remembered_arm(cockpit_->memory()); arm)
    known.arm = *arm;
  else
    complain(arm.error());
  return known;
}

void Service::keep_arm(const Scan& scan, const LineStep& step) const {
  const auto kept = remember_arm(scan.folder.filename().string(), step.arm, cockpit_->memory());
  if (!kept) complain(kept.error());
}

void Service::look_at_own_calibration(Scan& scan, const intake::ScanOutcome& outcome) const {
  if (outcome.failure || scan.calibration_checked || scan.calibration.valid()) return;
  // Who waits for it gets it at once; beside a moving arm it gives way.
  const bool gives_way = !options_.stop_on_drift;
  scan.calibration = std::async(std::launch::async, [&outcome, gives_way] {
    name_thread("bl-check", gives_way);
    return look_at_calibration(outcome);
  });
}

void Service::check_own_calibration(Scan& scan, const intake::ScanOutcome& outcome) {
  if (outcome.failure || scan.calibration_checked) return;
  scan.calibration_checked = true;
  if (options_.calibration_anew) {
    // A memory that is busy or full now takes it at the next scan.
    const Result<void> anew = begin_calibration_check_anew(cockpit_->memory(), user_name());
    options_.calibration_anew = !anew;
    if (!anew) complain(anew.error());
  }
  const OnDrift on_drift = options_.stop_on_drift ? OnDrift::Stop : OnDrift::Warn;
  const Result<ExitStatus> done = without_exceptions([&]() -> Result<ExitStatus> {
    const Result<drift::Evidence> evidence =
        scan.calibration.valid() ? scan.calibration.get() : look_at_calibration(outcome);
    BITELINE_ASSIGN(scan.drifted, check_calibration(scan.folder, evidence, outcome.sensor.model,
                                                    cockpit_->memory(), on_drift, scan.chosen.model));
    return ExitStatus::Done;
  });
  if (done) return;
  complain(done.error());
  // Nobody knows: with --on-drift stop a person looks.
  scan.drifted = options_.stop_on_drift;
}

Result<LineStep> Service::use_library(Scan& scan, const intake::ScanOutcome& outcome, LineStep found) {
  Chosen& chosen = scan.chosen;
  const Ordered now = ordered();
  chosen.model = now.job.model;
  chosen.process_name = now.job.process;
  if (!chosen.process_name.empty()) {
    chosen.process_by = now.who;
    chosen.taught = now.taught;
    chosen.taught_model = now.model;
  }
  const transfer::Library library = stock_for(chosen).models;
  if (outcome.failure || found.too_little_seen || (!options_.models && chosen.model.empty())) {
    BITELINE_TRY(choose_process(chosen));
    cockpit_->show_model(chosen.model, chosen.probability, {chosen.process_name, chosen.process_by});
    return found;
  }
  chosen.probability = 1;
  std::optional<transfer::Alignment> alignment;
  if (chosen.model.empty()) {
    BITELINE_ASSIGN(Recognised model, recognise(library, outcome.cloud));
    say_step("%s", model.words.c_str());
    cockpit_->show_model(model.name, model.probability, {chosen.process_name, chosen.process_by});
    // Without a line and without a model that is near, nobody could go on.
    const bool somebody_may = cockpit_->has_doors() && (found.line || !model.name.empty());
    if (!model.sure() && somebody_may) {
      chosen.unknown = model.words;
      return found;
    }
    if (!model.sure()) {
      BITELINE_TRY(found.pages.write(outcome.cloud));
      BITELINE_TRY(refuse_unknown(scan.folder, model.words, hash_of(chosen.release)));
      return LineStep{.status = ExitStatus::Refused, .confidence = 0, .line = {}};
    }
    chosen.model = model.name;
    chosen.probability = model.probability;
    alignment = std::move(model.alignment);
  }
  BITELINE_ASSIGN(transfer::SampleFiles sample, library.load(chosen.model));
  BITELINE_TRY(choose_process(chosen));
  // A model that was asked for together with a process is a person's word for both.
  if (now.job.model.empty()) look_at_other_process(chosen);
  cockpit_->show_model(chosen.model, chosen.probability, {chosen.process_name, chosen.process_by});
  if (found.line && found.status == ExitStatus::Review) {
    return carry_or_review(
        scan.folder,
        {.name = chosen.model, .sample = transfer::ReadySample{std::move(sample)}, .options = {}}, outcome,
        chosen, std::move(found));
  }
  if (found.line) {
    BITELINE_ASSIGN(
        found, heed_mended_model(
                   scan.folder, std::move(found), outcome.cloud,
                   {.name = chosen.model, .sample = sample, .on_scan = alignment ? &*alignment : nullptr}));
    if (alignment && found.line)
      chosen.places = places_of(*found.line, sample.line, alignment->T_upper_sample);
    return found;
  }
  // An upper without its sole: the model's line is carried over.
  return carry_line(scan.folder,
                    {.name = chosen.model, .sample = transfer::ReadySample{std::move(sample)}, .options = {}},
                    outcome, known_before(), hash_of(chosen.release));
}

Result<LineStep> Service::carry_or_review(const fs::path& folder, Carrier carrier,
                                          const intake::ScanOutcome& outcome, const Chosen& chosen,
                                          LineStep found) const {
  carrier.or_leave = true;
  BITELINE_ASSIGN(LineStep carried,
                  carry_line(folder, carrier, outcome, known_before(), hash_of(chosen.release)));
  return carried.line ? std::move(carried) : std::move(found);
}

Result<void> Service::choose_process(Chosen& chosen) const {
  if (!robot_) return {};
  const auto [release, library, processes] = stock_for(chosen);
  fs::path file;
  if (!chosen.process_name.empty()) {
    BITELINE_ASSIGN(const api::StoredProcess stored, processes.find(chosen.process_name));
    file = stored.file;
  } else if (!chosen.model.empty() && fs::exists(library.path_of(chosen.model) / transfer::k_process_file)) {
    file = library.path_of(chosen.model) / transfer::k_process_file;
  } else if (!release.empty()) {
    // A process of the same file name as --process stands in its place.
    if (const auto stored = processes.find(robot_->options.process.stem().string())) file = stored->file;
  }
  if (file.empty()) {
    chosen.process_name = robot_->process.process.name;
    return {};
  }
  BITELINE_ASSIGN(chosen.process, take_process(file));
  chosen.process_name = chosen.process->process.name;
  return {};
}

const TakenProcess& Service::taken_of(const Chosen& chosen) const {
  return chosen.process ? *chosen.process : robot_->process;
}

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
  const robot::ScanFacts facts = facts_of(scan, outcome);
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
  const bool must = needs_a_person(process_of(scan.chosen).gate, line.confidence) || drift_stops ||
                    !scan.chosen.other_process.empty();
  const bool goes = wanted && !must;
  const bool hold = (goes ? cockpit_->wants_hold_at_last(name) : cockpit_->wants_hold(name)) ||
                    !scan.chosen.other_process.empty();
  const bool asks = must || hold;
  const bool waits_for_person = wanted && asks && !facts.confirmed && cockpit_->has_doors();
  if (waits_for_person || (held && robot_->options.send)) {
    say_step("%s is held: a person must %s%s%s", name.c_str(),
             line.status == ExitStatus::Review ? "settle its line" : "accept it",
             scan.chosen.other_process.empty() ? "" : ": ", scan.chosen.other_process.c_str());
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

Result<ExitStatus> Service::work_named(Unnamed unnamed, const std::string& model) {
  Scan& scan = unnamed.scan;
  const fs::path folder = scan.folder;
  const std::string name = folder.filename().string();
  cockpit_->show(Phase::Working, "works out " + name + " as " + model, robot_ ? "its path" : "the next scan");
  Chosen chosen;
  chosen.model = model;
  // A job's process stays the job's, as where the model is recognised.
  chosen.process_name = scan.chosen.process_name;
  chosen.process_by = scan.chosen.process_by;
  chosen.taught = scan.chosen.taught;
  chosen.taught_model = scan.chosen.taught_model;
  // Of the release that it was looked for in.
  chosen.release = scan.chosen.release;
  Result<transfer::SampleFiles> sample = stock_for(chosen).models.load(model);
  const Result<void> process = sample ? choose_process(chosen) : Result<void>{};
  if (!sample || !process) {
    Error error = sample ? process.error() : sample.error();
    unnamed_.emplace(std::move(unnamed));
    return tl::unexpected<Error>{std::move(error)};
  }
  look_at_other_process(chosen);
  scan.chosen = chosen;
  cockpit_->show_model(chosen.model, 1, {chosen.process_name, chosen.process_by});
  const Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    LineStep line = std::move(unnamed.line);
    if (!line.line) {
      const Carrier carrier{
          .name = model, .sample = transfer::ReadySample{std::move(*sample)}, .options = {}};
      BITELINE_ASSIGN(line,
                      carry_line(folder, carrier, unnamed.outcome, known_before(), hash_of(chosen.release)));
      BITELINE_TRY(line.pages.write(unnamed.outcome.cloud));
      // The report is a new one.
      scan.calibration_checked = false;
      check_own_calibration(scan, unnamed.outcome);
    } else if (line.status == ExitStatus::Review) {
      Carrier carrier{.name = model, .sample = transfer::ReadySample{std::move(*sample)}, .options = {}};
      BITELINE_ASSIGN(line,
                      carry_or_review(folder, std::move(carrier), unnamed.outcome, chosen, std::move(line)));
      BITELINE_TRY(line.pages.write(unnamed.outcome.cloud));
    } else {
      BITELINE_ASSIGN(line, heed_mended_model(folder, std::move(line), unnamed.outcome.cloud,
                                              {.name = model, .sample = *sample}));
    }
    if (line.line && robot_)
      return work_out_path(scan, unnamed.outcome, line, line.status == ExitStatus::Review);
    end_recording(scan.intake, line.status);
    return line.status;
  });
  close_result(folder, chosen);
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

void Service::end_recording(intake::ScanIntake& intake, ExitStatus status) {
  if (!options_.kept.keeps(status != ExitStatus::Done)) intake.forget();
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
