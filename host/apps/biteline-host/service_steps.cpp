// SPDX-License-Identifier: MIT
// Several processes for one shoe, one after the other: each is a result of its own, with its own path, gate
// and look.  So is a rework: the same process, for what a look has found missing.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/system/file.hpp"
#include "host/apps/biteline-host/next_of.hpp"
#include "host/apps/biteline-host/refused.hpp"
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/records/evidence/evidence.hpp"
#include "host/records/look/rework_files.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"
#include "host/robot/path/mounted.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using StepJson = nlohmann::ordered_json;

/// More for one shoe is a process that comes back to itself by some way.
constexpr std::size_t k_most_processes = 10;

/// One look has to tell the work of one process from what was there before, and one tool from the next.
Result<void> check_pair(const path::Process& before, const path::Process& next) {
  if (next.after_work != path::AfterWork::None && before.after_work == path::AfterWork::None)
    return fail(Errc::NotSupported,
                "'%.80s' looks at its work, and '%.80s' before it does not: no look could tell the two "
                "apart; set after_work of the first, too",
                next.name.c_str(), before.name.c_str());
  const double apart_mm =
      (next.tool.T_flange_tcp.translation() - before.tool.T_flange_tcp.translation()).norm();
  const bool named = !next.tool.name.empty() && !before.tool.name.empty();
  if (named || apart_mm <= path::k_taught_tip_mm) return {};
  return fail(Errc::NotSupported,
              "the tips of '%.80s' and '%.80s' stand %.1f mm apart: name the tool of each (tool.name)",
              before.name.c_str(), next.name.c_str(), apart_mm);
}

/// What a person and a path need of the result before: its line, with its versions, and its report.
Result<void> copy_result(const fs::path& from, const fs::path& to) {
  std::error_code error;
  for (const char* name : {"line.csv", "report.json", "lines", "stages"}) {
    if (!fs::exists(from / name, error)) continue;
    fs::copy(from / name, to / name, fs::copy_options::recursive, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", (to / name).c_str());
  }
  return {};
}

Result<void> tell_step(const fs::path& folder, const std::string& of, const std::string& process,
                       std::size_t pieces) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(folder / "report.json", k_most_settings_bytes));
  StepJson report = StepJson::parse(text, nullptr, false);
  if (!report.is_object()) return fail(Errc::BadFormat, "%.200s: no report", folder.c_str());
  report["follows"] = {{"scan", of}, {"process", process}};
  if (pieces > 0) report["follows"]["rework_pieces"] = pieces;
  return report::write_file_atomically(folder / "report.json", report::to_text(report) + "\n");
}

}  // namespace

Result<void> Service::take_following(Chosen& chosen) const {
  chosen.following.clear();
  const api::ProcessStore processes = catalogue_for(chosen).processes;
  std::vector<std::string> known{taken_of(chosen).sha256};
  path::Process last = taken_of(chosen).process;
  while (!last.next_process.empty()) {
    const Result<api::StoredProcess> stored = processes.find(last.next_process);
    if (!stored)
      return fail(Errc::FileNotFound, "next_process of '%.80s': no saved process '%.64s'", last.name.c_str(),
                  last.next_process.c_str());
    BITELINE_ASSIGN(TakenProcess next, take_process(stored->file));
    BITELINE_TRY(check_pair(last, next.process));
    if (std::ranges::find(known, next.sha256) != known.end() || known.size() == k_most_processes)
      return fail(Errc::NotSupported,
                  "next_process of '%.80s': '%.64s' comes again; each process works a shoe once, and at most "
                  "%zu do",
                  last.name.c_str(), last.next_process.c_str(), k_most_processes);
    known.push_back(next.sha256);
    last = next.process;
    chosen.following.push_back(std::move(next));
  }
  return {};
}

std::string Service::cut_off(const fs::path& folder, const Chosen& chosen,
                             const Result<ExitStatus>& status) const {
  if (!chosen.in_sequence() || (status && *status == ExitStatus::Done) || !was_sent(folder)) return {};
  return folder.filename().string() + ": the process " + chosen.process_name +
         " was begun and not worked to its end; nothing that follows it is worked";
}

std::string Service::not_worked(const Chosen& chosen) {
  return chosen.follows + " is not worked " + (chosen.rework ? "once more" : "with " + chosen.process_name);
}

std::vector<path::Piece> Service::pieces_of(const Missing& rework) {
  std::vector<path::Piece> pieces;
  for (const second_look::ReworkPiece& piece : rework.pieces.pieces)
    pieces.push_back({.from_mm = piece.along.from_mm, .to_mm = piece.along.to_mm});
  return pieces;
}

Service::Worked Service::ask_a_person(Worked worked, const std::string& words) {
  log_step("%s; a person must look before the next scan", words.c_str());
  operator_control_->show_work(words, true);
  keep_asking(words);
  operator_control_->enter(CellEvent::AsksPerson);
  worked.asks = words;
  return worked;
}

Result<void> Service::take_step(AfterWork& after, std::optional<Missing> rework) const {
  Scan& scan = after.scan;
  const fs::path before = scan.folder;
  // What the next look is compared with: the work of this process on it, or for a rework none of it.
  const fs::path seen = after.looks > 0 && !rework ? look_folder(before, after.looks) : before;
  scan.folder = next_folder();
  BITELINE_TRY(report::prepare_folder(scan.folder));
  BITELINE_TRY(copy_result(before, scan.folder));
  std::error_code error;
  fs::copy_file(seen / "cloud.ply", scan.folder / "cloud.ply", error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", scan.folder.c_str());
  Chosen& chosen = scan.chosen;
  chosen.follows = before.filename().string();
  if (!rework) {
    chosen.process = std::move(chosen.following.front());
    chosen.following.erase(chosen.following.begin());
  }
  chosen.rework = std::move(rework);
  chosen.process_name = taken_of(chosen).process.name;
  chosen.other_process.clear();
  chosen.told_twice.clear();
  chosen.places.reset();
  const std::size_t pieces = chosen.rework ? chosen.rework->pieces.pieces.size() : 0;
  BITELINE_TRY(tell_step(scan.folder, chosen.follows, chosen.process_name, pieces));
  BITELINE_TRY(keep_process(scan.folder, chosen));
  BITELINE_ASSIGN(chosen.written, evidence::of_folder(scan.folder));
  chosen.written.process = taken_of(chosen).sha256;
  chosen.written.report.clear();  // it is not the last one yet
  // Once, whatever comes of it: before there is a path.
  if (chosen.rework)
    BITELINE_TRY(look::record_rework(before, {.look_sha256 = chosen.rework->look_sha256, .pieces = pieces}));
  return {};
}

Result<void> Service::plan_step(AfterWork& after) const {
  Planned& planned = after.planned;
  const Scan& scan = after.scan;
  path::PlanRequest request = planned.plan.request;
  if (scan.chosen.rework)
    request.process.only = pieces_of(*scan.chosen.rework);
  else
    request.process = process_to_plan(scan.chosen);
  BITELINE_ASSIGN(request.mounted, mounted(request.process));
  request.table_z_mm = request.mounted.table_z_mm.value_or(robot_->options.table_z_mm);
  cloud::ClosedLine line = request.line;
  BITELINE_ASSIGN(planned.plan, plan_again(scan.folder / "path", std::move(request), std::move(line)));
  SendRequest& send = planned.request;
  send.mounted = planned.plan.request.mounted;
  send.holds_arm = holds_arm();
  send.scan.name = scan.folder.filename().string();
  // A person's yes was to the path before.
  send.approved.reset();
  send.scan.confirmed.reset();
  send.looked = after.looked;
  send.looked_at = scan.folder;
  send.written = scan.chosen.written;
  send.process_file = taken_of(scan.chosen).file;
  return {};
}

NextStep Service::next_of_step(const AfterWork& after) const {
  const Planned& planned = after.planned;
  const robot::ScanFacts& seen = planned.request.scan;
  return next_of(
      {.sends = robot_->options.send,
       .has_path = planned.plan.outcome.path.has_value(),
       .doors = operator_control_->has_doors(),
       .seen = !seen.recovered && !seen.from_recording && seen.one_connection,
       .asks_by_gate = needs_a_person(planned.plan.request.process.gate, planned.request.confidence),
       .asked_to_hold = operator_control_->wants_hold_at_last(after.name()),
       .drift_stops = after.scan.drifted && options_.stop_on_drift,
       .looks = looks_of(after.scan.chosen, planned.request.mounted)});
}

void Service::tell_next_scan(const std::string& before, const std::string& next, bool owed) const {
  const fs::path folder = options_.out / before;
  Result<std::optional<WorkBook>> book = read_work(folder);
  if (book && !*book) return;
  if (!book) return log_error(book.error());
  (*book)->next_scan = next;
  if (!owed) (*book)->next.clear();
  if (const Result<void> written = write_work(folder, **book); !written) log_error(written.error());
}

std::string Service::leave_step(const Scan& scan) const {
  const std::string& before = scan.chosen.follows;
  if (before.empty()) return {};
  tell_next_scan(before, scan.folder.filename().string(), false);
  const std::string words = not_worked(scan.chosen) + ": a person has ended it";
  operator_control_->show_work(words, true);
  keep_asking(words);
  return words;
}

Service::Worked Service::begin_step(AfterWork after, std::optional<Missing> rework) {
  const std::string before = after.name();
  const std::string how = rework ? "once more" : "with " + after.scan.chosen.following.front().process.name;
  operator_control_->show("plans what follows for " + before + ": it is worked " + how, "the arm works it");
  Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    BITELINE_TRY(take_step(after, std::move(rework)));
    operator_control_->works(after.name());
    BITELINE_TRY(plan_step(after));
    return after.planned.plan.status;
  });
  const fs::path folder = after.scan.folder;
  const std::string name = after.name();
  const auto leave = [&](Result<ExitStatus> ended, const std::string& why) {
    tell_next_scan(before, name, false);
    Worked worked = close_result({.status = std::move(ended)}, folder, after.scan.chosen);
    return ask_a_person(std::move(worked), before + " is not worked " + how + ": " + why);
  };
  if (!status) return leave(status, to_line(status.error()));
  tell_next_scan(before, name, true);
  log_step("%s: %s is worked %s", name.c_str(), before.c_str(), how.c_str());
  const NextStep next = next_of_step(after);
  if (next.next == Next::Keep) return leave(status, "no path: " + after.planned.plan.outcome.reason());
  if (next.next == Next::Refuse) return leave(ExitStatus::Refused, next.why);
  if (next.next == Next::Hold) {
    const std::string why = looks_of(after.scan.chosen, after.planned.request.mounted);
    log_step("%s is held: a person must accept it%s%s", name.c_str(), why.empty() ? "" : ": ", why.c_str());
    Chosen chosen = after.scan.chosen;
    return close_result({.status = ExitStatus::Done,
                         .held = HeldScan{.scan = std::move(after.scan), .what = std::move(after.planned)}},
                        folder, std::move(chosen));
  }
  return follow_step(std::move(after));
}

Service::Worked Service::follow_step(AfterWork after) {
  const fs::path folder = after.scan.folder;
  const std::string before = after.scan.chosen.follows;
  operator_control_->enter(CellEvent::ArmSetsOut);
  operator_control_->show("the arm follows the line of " + after.name(), "what follows it");
  WorkedOut out{.status = without_exceptions([&] {
                  return follow_and_owe_look(folder, after.scan.chosen, [&] {
                    return follow_path(folder, after.planned.plan, after.planned.request);
                  });
                })};
  Chosen chosen = after.scan.chosen;
  if (!was_sent(folder)) {
    tell_next_scan(before, folder.filename().string(), false);
    Worked worked = close_result(std::move(out), folder, chosen);
    const std::string why = worked.end.told.reason;
    return ask_a_person(std::move(worked), not_worked(chosen) + ": " + why);
  }
  if (out.status && *out.status == ExitStatus::Done && goes_on_after(chosen))
    out.after = AfterWork{.scan = std::move(after.scan), .planned = std::move(after.planned)};
  return close_result(std::move(out), folder, std::move(chosen));
}

}  // namespace biteline::service
