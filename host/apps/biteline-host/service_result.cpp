// SPDX-License-Identifier: MIT
// A complete scan becomes a line.
#include <exception>
#include <utility>

#include "common/system/user_name.hpp"
#include "host/apps/biteline-host/arm_memory.hpp"
#include "host/apps/biteline-host/attempt.hpp"
#include "host/apps/biteline-host/calibration_check.hpp"
#include "host/apps/biteline-host/part.hpp"
#include "host/apps/biteline-host/prior_step.hpp"
#include "host/apps/biteline-host/recognise.hpp"
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/records/evidence/evidence.hpp"
#include "host/transfer/models.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

std::string hash_of(const std::optional<release::InForce>& release) {
  return release ? release->hash : std::string{};
}

}  // namespace

const Service::Chosen& Service::chosen_of(const WorkedOut& out, const Scan& scan) {
  return out.held ? out.held->scan.chosen : out.after ? out.after->scan.chosen : scan.chosen;
}

Service::Worked Service::work_out(Scan scan) {
  operator_control_->show("works out the line of " + scan.folder.filename().string(),
                          robot_ ? "its path" : "the next scan");
  const fs::path folder = scan.folder;
  WorkedOut out = work_out_files(scan);
  Chosen chosen = chosen_of(out, scan);
  return close_result(std::move(out), folder, std::move(chosen));
}

Service::Worked Service::close_result(WorkedOut out, const fs::path& folder, Chosen chosen) {
  const ShoeWords shoe{.part = chosen.part, .foot = chosen.foot, .size = chosen.size};
  if (const Result<void> told = tell_shoe(folder, shoe); !told) log_error(told.error());
  // From here on nobody but a mend writes them.
  if (const Result<memory::Evidence> now = evidence::of_folder(folder)) {
    if (chosen.written == memory::Evidence{}) chosen.written = *now;
    chosen.written.report = now->report;
    if (out.held) out.held->scan.chosen.written = chosen.written;
    if (Planned* const planned = out.held ? out.held->planned() : nullptr)
      planned->request.written = chosen.written;
    if (out.after) out.after->scan.chosen.written = out.after->planned.request.written = chosen.written;
  } else {
    log_error(now.error());
  }
  const Remembered told = remember(folder, out.held ? "held" : "open", chosen,
                                   {.goes_on = out.after.has_value()}, out.held ? &*out.held : nullptr);
  if (!told.waits) out.held.reset();
  if (const Result<void> room = make_room(); !room) log_error(room.error());
  const std::string cut = cut_off(folder, chosen, out.status);
  Worked worked{.status = std::move(out.status), .held = std::move(out.held), .end = told.end};
  if (!cut.empty()) return ask_a_person(std::move(worked), cut);
  if (out.after && !looks_after(chosen)) return begin_step(std::move(*out.after));
  worked.after = std::move(out.after);
  return worked;
}

Service::Worked Service::hold_again(Result<ExitStatus> status, HeldScan held, const std::string& failed) {
  const Remembered told = remember(held.scan.folder, "held", held.scan.chosen, {.failed = failed}, &held);
  Worked worked{.status = std::move(status), .held = {}, .end = told.end};
  if (told.waits) worked.held.emplace(std::move(held));
  return worked;
}

Service::Worked Service::wait_on(HeldScan held, Error error) {
  tell_held(held);
  operator_control_->tell_scan(held.name());
  return {.status = tl::unexpected<Error>{std::move(error)}, .held = std::move(held)};
}

Service::WorkedOut Service::work_out_files(Scan& scan) {
  if (const Result<void> marked = mark_attempt(scan.folder); !marked)
    return {.status = tl::unexpected<Error>{marked.error()}};
  intake::ScanOutcome outcome;
  LineStep line;
  const auto path_follows = [&] {
    return scan.chosen.unknown.empty() && line.line.has_value() && robot_.has_value();
  };
  Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    // Beside the line, so that the path waits for neither.
    if (robot_ && robot_->options.send)
      scan.arm_seen = std::async(std::launch::async, see_arm, controller(), robot_->arm);
    BITELINE_ASSIGN(line, work_out_line(scan, outcome));
    scan.line.reset();
    if (!path_follows()) BITELINE_TRY(line.pages.write(outcome.cloud));
    return line.status;
  });
  if (status && !path_follows()) check_own_calibration(scan, outcome);
  if (!status) {
    // A disk that is full or a folder that is gone is not the scan's fault: it is taken up again.
    const bool own_fault = status.error().code != Errc::DiskFull && status.error().code != Errc::WriteFailed;
    if (!own_fault) clear_attempt(scan.folder);
    if (!own_fault || !set_aside(scan.folder, to_line(status.error()))) return {.status = std::move(status)};
    return {.status = ExitStatus::Refused};
  }
  clear_attempt(scan.folder);
  if (!scan.chosen.unknown.empty()) {
    log_step("%s is held: its model is not known: %s", scan.folder.filename().c_str(),
             scan.chosen.unknown.c_str());
    return {.status = ExitStatus::Done,
            .held = HeldScan{.scan = std::move(scan),
                             .what = Unnamed{.outcome = std::move(outcome), .line = std::move(line)}}};
  }
  if (!line.line || !robot_) {
    end_recording(scan.intake, *status);
    return {.status = std::move(status)};
  }
  const bool review = line.status == ExitStatus::Review;
  WorkedOut out = path_without_exceptions(scan, outcome, line, review && operator_control_->has_doors());
  // No path is planned along it, and that is not why it ends.
  if (out.status && review && !out.held) out.status = ExitStatus::Review;
  const Result<ExitStatus> pages = without_exceptions([&]() -> Result<ExitStatus> {
    BITELINE_TRY(line.pages.write(outcome.cloud));
    return ExitStatus::Done;
  });
  if (!pages) log_error(pages.error());
  check_own_calibration(out.held ? out.held->scan : out.after ? out.after->scan : scan, outcome);
  return out;
}

Service::WorkedOut Service::path_without_exceptions(Scan& scan, const intake::ScanOutcome& outcome,
                                                    LineStep& line, bool waits) {
  WorkedOut out{.status = ExitStatus::Refused};
  const Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    BITELINE_ASSIGN(out, work_out_path(scan, outcome, line, waits));
    return out.status;
  });
  if (!status) out.status = tl::unexpected<Error>{status.error()};
  return out;
}

Result<void> Service::choose_release(Chosen& chosen) const {
  if (options_.releases.empty()) return {};
  BITELINE_ASSIGN(chosen.release, release::in_force(options_.releases, memory::now_ms()));
  return {};
}

api::Catalogue Service::catalogue_for(const Chosen& chosen) const {
  return catalogue_of(chosen.release, catalogue_folders(options_));
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
  if (const auto arm = remembered_arm(operator_control_->memory()); arm)
    known.arm = *arm;
  else
    log_error(arm.error());
  return known;
}

void Service::keep_arm(const Scan& scan, const LineStep& step) const {
  const auto kept = remember_arm(scan.folder.filename().string(), step.arm, operator_control_->memory());
  if (!kept) log_error(kept.error());
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
    const Result<void> anew = begin_calibration_check_anew(operator_control_->memory(), user_name());
    options_.calibration_anew = !anew;
    if (!anew) log_error(anew.error());
  }
  const OnDrift on_drift = options_.stop_on_drift ? OnDrift::Stop : OnDrift::Warn;
  const Result<ExitStatus> done = without_exceptions([&]() -> Result<ExitStatus> {
    const Result<drift::Evidence> evidence =
        scan.calibration.valid() ? scan.calibration.get() : look_at_calibration(outcome);
    BITELINE_ASSIGN(scan.drifted,
                    check_calibration(scan.folder, evidence, outcome.sensor.model,
                                      operator_control_->memory(), on_drift, scan.chosen.model));
    return ExitStatus::Done;
  });
  if (done) return;
  log_error(done.error());
  // Nobody knows: with --on-drift stop a person looks.
  scan.drifted = options_.stop_on_drift;
}

void Service::Chosen::take(const Recognised& recognised) {
  model = recognised.model;
  sample = recognised.sample;
  probability = recognised.probability;
  if (!recognised.foot.empty()) foot = recognised.foot;
  if (!recognised.size.empty()) size = recognised.size;
}

Result<LineStep> Service::use_library(Scan& scan, const intake::ScanOutcome& outcome, LineStep found) {
  Chosen& chosen = scan.chosen;
  const Ordered now = ordered();
  const transfer::ModelOrder order{.model = now.job.model, .foot = now.job.foot, .size = now.job.size};
  chosen.model = order.model;
  chosen.foot = order.foot;
  chosen.size = order.size;
  chosen.process_name = now.job.process;
  if (!chosen.process_name.empty()) {
    chosen.process_by = now.who;
    chosen.taught = now.taught;
    chosen.taught_model = now.model;
  }
  const transfer::Library library = catalogue_for(chosen).models;
  if (outcome.failure || found.too_little_seen || (!options_.models && chosen.model.empty())) {
    BITELINE_TRY(choose_process(chosen));
    operator_control_->show_model(chosen.model, chosen.probability, {chosen.process_name, chosen.process_by});
    return found;
  }
  BITELINE_ASSIGN(const Recognised model, options_.models ? recognise(library, outcome.cloud, order)
                                                          : take_named(library, outcome.cloud, order));
  log_step("%s", model.words.c_str());
  if (!model.sure()) {
    // Perhaps it is not the shoe that was ordered: no stretch is laid by the order's foot alone.
    chosen.foot.clear();
    chosen.size.clear();
    operator_control_->show_model(model.model, model.probability, {chosen.process_name, chosen.process_by});
    // Without a line and without a model that is near, nobody could go on.
    const bool somebody_may =
        operator_control_->has_doors() && (found.line || !model.model.empty() || !order.model.empty());
    if (somebody_may) {
      chosen.unknown = model.words;
      return found;
    }
    BITELINE_TRY(found.pages.write(outcome.cloud));
    BITELINE_TRY(refuse_unknown(scan.folder, model.words, hash_of(chosen.release)));
    return LineStep{.status = ExitStatus::Refused, .confidence = 0, .line = {}};
  }
  chosen.take(model);
  BITELINE_ASSIGN(transfer::SampleFiles sample, library.load(chosen.sample));
  BITELINE_TRY(choose_process(chosen));
  // A model that was asked for together with a process is a person's word for both.
  if (order.model.empty()) look_at_other_process(chosen);
  operator_control_->show_model(chosen.model, chosen.probability, {chosen.process_name, chosen.process_by});
  operator_control_->show_shoe({.part = chosen.part, .foot = chosen.foot, .size = chosen.size});
  return use_model(scan.folder, outcome, chosen, model, std::move(sample), std::move(found));
}

Result<LineStep> Service::use_model(const fs::path& folder, const intake::ScanOutcome& outcome,
                                    Chosen& chosen, const Recognised& model, transfer::SampleFiles sample,
                                    LineStep found) const {
  if (found.line && found.status == ExitStatus::Done) {
    BITELINE_ASSIGN(found, heed_mended_model(folder, std::move(found), outcome.cloud,
                                             {.name = chosen.model,
                                              .sample = sample,
                                              .on_scan = model.on_scan ? &*model.on_scan : nullptr}));
    if (model.on_scan && found.line) chosen.places = places_of(*found.line, model.on_scan->line);
    return found;
  }
  Carrier carrier{.name = chosen.sample,
                  .sample = transfer::ReadySample{std::move(sample)},
                  .options = {.align = model.align}};
  if (found.line) return carry_or_review(folder, std::move(carrier), outcome, chosen, std::move(found));
  // An upper without its sole: the model's line is carried over.
  return carry_line(folder, carrier, outcome, known_before(), hash_of(chosen.release));
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
  const auto [release, library, processes] = catalogue_for(chosen);
  fs::path file;
  if (!chosen.process_name.empty()) {
    BITELINE_ASSIGN(const api::StoredProcess stored, processes.find(chosen.process_name));
    file = stored.file;
  } else if (!chosen.model.empty()) {
    file = transfer::process_of(library, chosen.model, chosen.sample);
  }
  if (file.empty() && chosen.process_name.empty() && !release.empty()) {
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

Service::Worked Service::work_named(HeldScan held, const std::string& model) {
  const fs::path folder = held.scan.folder;
  Unnamed& unnamed = *held.unnamed();
  operator_control_->show("works out " + held.name() + " as " + model, robot_ ? "its path" : "the next scan");
  Chosen chosen = chosen_anew(held.scan.chosen);
  // A job's process stays the job's, as where the model is recognised.
  chosen.process_name = held.scan.chosen.process_name;
  chosen.process_by = held.scan.chosen.process_by;
  chosen.taught = held.scan.chosen.taught;
  chosen.taught_model = held.scan.chosen.taught_model;
  const transfer::Library library = catalogue_for(chosen).models;
  const Result<Recognised> named = take_named(library, unnamed.outcome.cloud, {.model = model});
  if (!named) return wait_on(std::move(held), named.error());
  chosen.take(*named);
  Result<transfer::SampleFiles> sample = library.load(chosen.sample);
  if (!sample) return wait_on(std::move(held), sample.error());
  if (const Result<void> process = choose_process(chosen); !process)
    return wait_on(std::move(held), process.error());
  look_at_other_process(chosen);
  Scan scan = std::move(held.scan);
  scan.chosen = std::move(chosen);
  operator_control_->show_model(scan.chosen.model, 1, {scan.chosen.process_name, scan.chosen.process_by});
  WorkedOut out{.status = ExitStatus::Refused};
  const Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    const bool was_line = unnamed.line.line.has_value();
    const bool for_review = unnamed.line.status == ExitStatus::Review;
    BITELINE_ASSIGN(LineStep line, use_model(folder, unnamed.outcome, scan.chosen, *named, std::move(*sample),
                                             std::move(unnamed.line)));
    if (!was_line || for_review) BITELINE_TRY(line.pages.write(unnamed.outcome.cloud));
    if (!was_line) {
      // The report is a new one.
      scan.calibration_checked = false;
      check_own_calibration(scan, unnamed.outcome);
    }
    if (line.line && robot_) {
      BITELINE_ASSIGN(out, work_out_path(scan, unnamed.outcome, line, line.status == ExitStatus::Review));
      return out.status;
    }
    end_recording(scan.intake, line.status);
    return line.status;
  });
  out.status = status;
  Chosen worked = chosen_of(out, scan);
  return close_result(std::move(out), folder, std::move(worked));
}

void Service::end_recording(intake::ScanIntake& intake, ExitStatus status) {
  if (!options_.kept.keeps(status != ExitStatus::Done)) intake.forget();
}

}  // namespace biteline::service
