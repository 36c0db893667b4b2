// SPDX-License-Identifier: MIT
// A shoe that was worked is looked at once more; what is missing becomes a step of its own, looked at again.
#include <algorithm>
#include <utility>

#include "host/apps/biteline-host/refused.hpp"
#include "host/apps/biteline-host/scan_row.hpp"
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/cloud/ply.hpp"
#include "host/records/digest/digest.hpp"
#include "host/records/look/planned_band.hpp"
#include "host/records/look/rework_files.hpp"
#include "host/report/report.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

/// WorkBook::next of a rework, in place of a process.
constexpr const char* k_once_more = "once more";
/// In the memory's settings: why a person must look before the next scan.
constexpr const char* k_asks_key = "look_by_a_person";

std::string in_one_line(std::string words) {
  for (std::size_t at = words.find('\n'); at != std::string::npos; at = words.find('\n', at))
    words.replace(at, 1, "; ");
  return words;
}

/// A service before this one left it so, and nobody knows more.
void close_book(WorkBook& book) {
  const std::string next = std::exchange(book.next, {});
  const bool at_work = std::exchange(book.at_work, false);
  if (book.work.verdict == k_looking) {
    book.work.verdict = k_not_looked;
    book.told = report::told(
        Refusal{.code = Refused::WorkNotLookedAt,
                .reason = "not looked at: the service ended between the work and the look at it"});
  } else if (book.work.verdict == k_faulty) {
    book.told.reason += "; the service ended before it was worked " + next;
  } else {
    book.told = report::told(
        Refusal{.code = Refused::SequenceCut,
                .reason = at_work ? "the service ended while the arm worked it"
                                  : "the service ended before the shoe was worked with " + next});
  }
  if (!next.empty() && book.work.verdict == k_not_looked) book.told.reason += "; not worked with " + next;
}

}  // namespace

bool Service::looks_after(const Chosen& chosen) const {
  return robot_ && taken_of(chosen).process.after_work != path::AfterWork::None;
}

Result<ExitStatus> Service::follow_and_owe_look(const fs::path& folder, const Chosen& chosen,
                                                const std::function<Result<ExitStatus>()>& follow) const {
  const bool looks = looks_after(chosen);
  if (!looks && !chosen.in_sequence()) return follow();
  // Before anything moves: a service after this one must know that the shoe may have been worked.
  WorkBook book{.work = {.verdict = looks ? k_looking : ""}, .at_work = true};
  if (!chosen.following.empty()) book.next = chosen.following.front().process.name;
  BITELINE_TRY(write_work(folder, book));
  Result<ExitStatus> status = follow();
  const bool done = status && *status == ExitStatus::Done;
  if (!chosen.follows.empty() && was_sent(folder)) {
    tell_next_scan(chosen.follows, folder.filename().string(), false);
    if (chosen.rework) tell_reworked(chosen.follows);
  }
  if (!done || !goes_on_after(chosen)) {
    forget_work(folder);
  } else if (!looks) {
    book.at_work = false;
    BITELINE_TRY(write_work(folder, book));
  }
  return status;
}

bool Service::inspects() const {
  return after_ && !result_.valid() && operator_control_->cell().shoe() == Shoe::Inspecting;
}

Result<void> Service::begin_inspection(const intake::Hello& hello) {
  const fs::path folder = look_folder(after_->scan.folder, after_->looks + 1);
  std::error_code error;
  fs::remove_all(folder, error);
  BITELINE_TRY(report::prepare_folder(folder));
  BITELINE_ASSIGN(intake::ScanIntake intake, intake::ScanIntake::begin(folder, hello, link_->packet()));
  scan_.emplace(Scan{.folder = folder, .intake = std::move(intake), .line = {}, .connection = connection()});
  scan_->after_work = true;
  scan_->mark = after_->scan.mark;
  asked_.reset();
  operator_control_->enter(CellEvent::ScanBegins);
  show_scan(*scan_);
  log_step("looks at what was done to %s", after_->name().c_str());
  return {};
}

void Service::give_up_inspection(const std::string& why) {
  begin_result(after_->name(), [this, why, after = std::move(*after_)]() mutable {
    const WorkBook book{.looks = after.looks};
    return end_unlooked(std::move(after), book, why);
  });
  after_.reset();
}

Service::Worked Service::inspect_work(AfterWork after, Scan look) {
  const std::string name = after.name();
  operator_control_->show("compares what was done to " + name, "what is missing");
  WorkBook book{.looks = after.looks};
  std::string why_not;
  std::optional<Inspected> seen;
  const Result<ExitStatus> done = without_exceptions([&]() -> Result<ExitStatus> {
    const intake::ScanOutcome outcome = look.intake.finish();
    look.intake.forget();
    if (!look.stopped_by.empty()) why_not = "stopped by " + look.stopped_by;
    if (why_not.empty() && after.scan.mark.stopped()) why_not = "it was stopped";
    if (why_not.empty() && outcome.failure) why_not = to_line(*outcome.failure);
    if (!why_not.empty()) return ExitStatus::Refused;
    BITELINE_ASSIGN(seen, inspect_files(after, outcome.cloud, look.ended.value_or(now())));
    after.looked.reset();
    if (seen->findings.moved.verdict == transfer::Moved::Verdict::Unmoved)
      after.looked = Looked{.at = seen->at, .shows = shown_by(seen->findings.moved)};
    return seen->judged.status;
  });
  if (!done) return end_unlooked(std::move(after), book, to_line(done.error()));
  if (!why_not.empty()) return end_unlooked(std::move(after), book, why_not);
  book.looks = ++after.looks;
  book.work = work_of(seen->findings, seen->judged.status);
  book.told = seen->judged.told;
  log_step("%s: %s", name.c_str(), in_one_line(look::summary(seen->findings)).c_str());
  const Chosen& chosen = after.scan.chosen;
  const bool may = taken_of(chosen).process.after_work == path::AfterWork::Rework && !chosen.rework;
  const bool ran_out = book.told.reason_code == report::refusal_row(second_look::Settle::WorkRanOut).name;
  if (may && !ran_out && book.work.verdict == k_faulty && *book.work.missing_mm > 0)
    return rework(std::move(after), *seen, std::move(book));
  return end_work(std::move(after), std::move(book), done);
}

Result<Service::Inspected> Service::inspect_files(const AfterWork& after, const cloud::PointCloud& seen,
                                                  HostClock::time_point at) const {
  const fs::path folder = look_folder(after.scan.folder, after.looks + 1);
  report::Report report;
  BITELINE_ASSIGN(const cloud::PointCloud first,
                  report.timed("read", [&] { return cloud::read_cloud(after.scan.folder / "cloud.ply"); }));
  const cloud::ClosedLine& line = after.planned.plan.request.line;
  Inspected inspected{.at = at};
  const Chosen& chosen = after.scan.chosen;
  if (chosen.rework) {
    // All of the band, and not its pieces alone.
    inspected.plan = chosen.rework->band;
  } else {
    BITELINE_ASSIGN(inspected.plan, look::planned_band(line, process_of(chosen), {}));
    const path::PlannedPath& path = after.planned.plan.outcome.path->path();
    inspected.plan.middle_base = look::middle_of(path);
    if (const auto seam = look::seam_of(path, line)) inspected.plan.twice.push_back(*seam);
  }
  inspected.findings =
      report.timed("compare", [&] { return second_look::look_again(first, seen, line, inspected.plan); });
  BITELINE_TRY(cloud::write_cloud(folder / "cloud.ply", seen));
  look::LookOf of{.first = after.name(),
                  .second = folder.filename().string(),
                  .line_sha256 = {},
                  .process_sha256 = taken_of(chosen).sha256,
                  .foot = chosen.foot,
                  .reworks = chosen.rework ? 1U : 0U,
                  .path_end_mm = {}};
  if (!chosen.rework) of.path_end_mm = look::end_of(after.planned.plan.outcome.path->path(), line);
  BITELINE_ASSIGN(of.line_sha256, digest_of_file(after.scan.folder / "line.csv"));
  BITELINE_ASSIGN(inspected.judged,
                  look::write_look_result(folder, inspected.findings, inspected.plan, of, report));
  BITELINE_TRY(report.write(folder));
  BITELINE_ASSIGN(inspected.sha256, digest_of_file(folder / "report.json"));
  return inspected;
}

Service::Worked Service::rework(AfterWork after, const Inspected& seen, WorkBook book) {
  Missing missing{
      .pieces = second_look::rework_of(seen.findings.faults, seen.plan, seen.findings.line_mm, {}),
      .band = seen.plan,
      .look_sha256 = seen.sha256};
  const std::string name = after.name();
  if (missing.pieces.pieces.empty()) {
    const char* why = "what is missing does not go away without working more than 1 mm twice";
    log_step("%s is not worked once more: %s", name.c_str(), why);
    book.told.reason.append("; not worked once more: ").append(why);
    return end_work(std::move(after), std::move(book), ExitStatus::Review);
  }
  book.next = k_once_more;
  if (const Result<void> written = write_work(after.scan.folder, book); !written) log_error(written.error());
  static_cast<void>(remember(after.scan.folder, "open", after.scan.chosen, {.goes_on = true}));
  log_step("%s: %zu pieces are missing, and are worked once more", name.c_str(),
           missing.pieces.pieces.size());
  return begin_step(std::move(after), std::move(missing));
}

void Service::tell_reworked(const std::string& before) const {
  const fs::path folder = options_.out / before;
  Result<std::optional<WorkBook>> book = read_work(folder);
  if (book && !*book) return;
  if (!book) return log_error(book.error());
  (*book)->work.reworked = true;
  (*book)->told = {};
  if (const Result<void> written = write_work(folder, **book); !written) return log_error(written.error());
  put_work_row(before);
}

void Service::put_work_row(const std::string& scan) const {
  std::optional<memory::Scan> row = row_of(options_.out / scan);
  if (!row) return;
  if (const auto known = operator_control_->memory().scan(scan); known && *known) {
    // What the row has besides its files stays.
    memory::Scan kept = **known;
    kept.work = row->work;
    kept.reason_code = row->reason_code;
    kept.reason = row->reason;
    kept.next_step = row->next_step;
    row = std::move(kept);
  }
  const Result<void> put = operator_control_->memory().put_scan(*row, {.id = 0,
                                                                       .time = memory::now_ms(),
                                                                       .who = "service",
                                                                       .door = {},
                                                                       .action = "result",
                                                                       .subject = scan,
                                                                       .before = {},
                                                                       .after = row->work.verdict});
  if (!put) log_error(put.error());
}

Service::Worked Service::end_unlooked(AfterWork after, WorkBook book, const std::string& why) {
  book.work.verdict = k_not_looked;
  book.work.missing_mm.reset();
  book.told = report::told(Refusal{.code = Refused::WorkNotLookedAt, .reason = "not looked at: " + why});
  return end_work(std::move(after), std::move(book), ExitStatus::Review);
}

Service::Worked Service::end_work(AfterWork after, WorkBook book, Result<ExitStatus> status) {
  const std::string name = after.name();
  const Chosen& chosen = after.scan.chosen;
  const bool asks = book.work.verdict != k_work_ok;
  const bool follows = !chosen.following.empty();
  if (follows && asks) book.told.reason += "; not worked with " + chosen.following.front().process.name;
  if (follows && !asks) book.next = chosen.following.front().process.name;
  if (const Result<void> written = write_work(after.scan.folder, book); !written) log_error(written.error());
  const std::string words = name + ": " + (asks ? book.told.reason : "all of the band is worked");
  if (asks && !operator_control_->has_doors())
    log_step("no door is open: start the service again once a person has looked");
  Worked worked{.status = std::move(status)};
  // Before doors hear of it: a start that comes after the row is a word about it.
  if (asks) {
    worked = ask_a_person(std::move(worked), words);
  } else {
    log_step("%s", words.c_str());
    operator_control_->show_work(words, false);
  }
  worked.end = remember(after.scan.folder, "open", chosen, {.goes_on = follows && !asks}).end;
  return follows && !asks ? begin_step(std::move(after)) : std::move(worked);
}

void Service::keep_asking(const std::string& words) const {
  const Result<void> put =
      operator_control_->memory().put_setting(k_asks_key, words,
                                              {.id = 0,
                                               .time = memory::now_ms(),
                                               .who = "service",
                                               .door = {},
                                               .action = "look by a person",
                                               .subject = "cell",
                                               .before = {},
                                               .after = words.empty() ? "done" : "asked for"});
  if (!put) log_error(put.error());
}

void Service::close_held_step(const std::string& scan, const report::ToldRefusal& told) const {
  if (scan.empty()) return;
  const Result<std::optional<memory::Scan>> known = operator_control_->memory().scan(scan);
  if (!known || !*known || (*known)->decision != "held") return;
  memory::Scan row = **known;
  row.decision = "open";
  row.reason_code = told.reason_code;
  row.reason = told.reason;
  row.next_step = told.next_step;
  const Result<void> put = operator_control_->memory().put_scan(row, {.id = 0,
                                                                      .time = memory::now_ms(),
                                                                      .who = "service",
                                                                      .door = {},
                                                                      .action = "result",
                                                                      .subject = scan,
                                                                      .before = "held",
                                                                      .after = row.decision});
  if (!put) log_error(put.error());
}

void Service::close_owed_looks() {
  // Where no door is open, whoever starts the service has looked.
  const Result<std::optional<std::string>> asked = operator_control_->memory().setting(k_asks_key);
  if (!asked) log_error(asked.error());
  if (asked && *asked && operator_control_->has_doors()) asks_ = **asked;
  if (asked && *asked && !(*asked)->empty() && !operator_control_->has_doors()) keep_asking({});
  std::error_code error;
  for (fs::directory_iterator at{options_.out, error}, end; !error && at != end; at.increment(error)) {
    const fs::path folder = at->path();
    Result<std::optional<WorkBook>> book = read_work(folder);
    if (!book) {
      log_error(book.error());
      continue;
    }
    if (!*book) continue;
    const bool begun = (*book)->work.verdict == k_looking || (*book)->at_work;
    if (begun && !was_sent(folder)) {
      forget_work(folder);
      continue;
    }
    const std::string& next_scan = (*book)->next_scan;
    const bool owes_step =
        !(*book)->next.empty() && (next_scan.empty() || !was_sent(options_.out / next_scan));
    if (!begun && !owes_step) continue;
    const std::string name = folder.filename().string();
    close_book(**book);
    if (const Result<void> written = write_work(folder, **book); !written) log_error(written.error());
    put_work_row(name);
    asks_ = name + ": " + (*book)->told.reason;
    close_held_step((*book)->next_scan, (*book)->told);
  }
  if (asks_.empty()) return;
  log_step("%s", asks_.c_str());
  operator_control_->show_work(asks_, true);
  // One scan was asked for by whoever started it: that is a person's word.
  if (options_.once) return asks_.clear();
  keep_asking(asks_);
  log_step("no scan is asked for before a person has looked%s",
           operator_control_->has_doors() ? " and started" : " and started the service again");
  operator_control_->enter(CellEvent::AsksPerson);
}

}  // namespace biteline::service
