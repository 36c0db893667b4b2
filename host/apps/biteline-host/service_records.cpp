// SPDX-License-Identifier: MIT
// What stays of a scan: its row in the memory, and its folder as long as retention keeps it.
#include <string>

#include "host/apps/biteline-host/black_box.hpp"
#include "host/apps/biteline-host/part.hpp"
#include "host/apps/biteline-host/refused.hpp"
#include "host/apps/biteline-host/scan_row.hpp"
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/records/evidence/evidence.hpp"
#include "host/records/memory/history.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

/// Of what was looked at; nothing: all is as the service wrote it, or nobody knows.
std::optional<std::string> changed_files(const fs::path& folder, const memory::Evidence& written) {
  const Result<memory::Evidence> now = evidence::of_folder(folder);
  return now ? evidence::change(written, *now) : std::nullopt;
}

}  // namespace

Service::Remembered Service::remember(const fs::path& folder, const std::string& decision,
                                      const Chosen& chosen, const After& after, const HeldScan* held) {
  std::optional<memory::Scan> row = row_of(folder);
  if (!row) {
    // No report: a device or the disk failed, not the scan.
    row.emplace();
    row->name = folder.filename().string();
    row->time = memory::now_ms();
    row->verdict = "failed";
  }
  std::unique_lock words = operator_control_->between_words();
  const Result<std::optional<memory::Scan>> before = operator_control_->memory().scan(row->name);
  const bool known = before && *before;
  if (const std::optional<std::string> changed = known ? changed_files(folder, chosen.written) : std::nullopt;
      changed && !row->sent) {
    // What another program wrote is believed in nothing.
    row->verdict = "refused";
    row->length_mm = (*before)->length_mm;
    row->confidence = (*before)->confidence;
    row->u95_mm = (*before)->u95_mm;
    row->tip_bound_mm = (*before)->tip_bound_mm;
    const auto& told = report::refusal_row(robot::Refused::FilesChanged);
    row->reason_code = told.name;
    row->reason = *changed;
    row->next_step = told.next_step;
  }
  // What was sent says itself whose yes it went by.
  if (!row->sent || decision == "accepted") row->decision = decision;
  bool still_held = held != nullptr;
  if (before && *before) {
    // A person's word stands.
    if (!(*before)->decided_by.empty()) row->decided_by = (*before)->decided_by;
    row->decided_at = (*before)->decided_at;
    row->why = (*before)->why;
    if ((*before)->decision == "rejected") {
      row->decision = "rejected";
      still_held = false;
    }
    // A yes that the stop came after.
    if (after.stopped && (*before)->decision == "accepted") row->decision = "accepted";
  }
  row->cycle_s = operator_control_->cycle_s();
  row->process = chosen.process_name;
  row->model = chosen.model;
  // A scan that nobody came to work out has them in its folder alone.
  if (!chosen.part.empty()) row->part = chosen.part;
  if (!chosen.foot.empty()) row->foot = chosen.foot;
  if (!chosen.size.empty()) row->size = chosen.size;
  operator_control_->show_shoe({.part = row->part, .foot = row->foot, .size = row->size});
  if (chosen.probability > 0) row->model_probability = chosen.probability;
  if (const std::optional<accounts::Holder> holder = operator_control_->accounts().holder())
    row->operator_name = holder->name;
  if (!chosen.unknown.empty()) {
    const report::ToldRefusal told = report::told(
        Refusal{.code = Refused::ModelUnknown, .reason = "the model is not known: " + chosen.unknown});
    row->reason_code = told.reason_code;
    row->reason = told.reason;
    row->next_step = "choose its model, or reject it";
  }
  if (after.stopped) {
    const report::ToldRefusal told = report::told(report::Refusal<robot::Refused>{
        .code = robot::Refused::Stopped, .reason = "stopped while it waited for a person"});
    row->reason_code = told.reason_code;
    row->reason = told.reason;
    row->next_step = told.next_step;
  } else if (still_held && chosen.unknown.empty() && !chosen.other_process.empty() &&
             row->reason_code.empty()) {
    const report::ToldRefusal told =
        report::told(Refusal{.code = Refused::OtherProcess, .reason = chosen.other_process});
    row->reason_code = told.reason_code;
    row->reason = told.reason;
    row->next_step = told.next_step;
  }
  // Also where no door is open and nothing waits.
  const bool has_line = row->verdict == "ok" || row->verdict == "amber" || row->verdict == "review";
  const std::string twice = has_line && !row->sent && chosen.follows.empty()
                                ? worked_before(operator_control_->memory(), row->name, row->part)
                                : "";
  if (!twice.empty() && !row->reason_code.empty()) {
    row->reason += "; " + twice;
  } else if (!twice.empty()) {
    const report::ToldRefusal told =
        report::told(Refusal{.code = Refused::PartWorkedBefore, .reason = twice});
    row->reason_code = told.reason_code;
    row->reason = told.reason;
    row->next_step = told.next_step;
  }
  if (!after.failed.empty()) {
    row->reason = "not sent: " + after.failed;
    row->next_step = "mend what the reason names, then accept it again";
  }
  row->versions.assign(R"({"program":")").append(BITELINE_VERSION);
  if (chosen.release) row->versions.append(R"(","release":")").append(chosen.release->hash);
  row->versions.append("\"}");
  const Result<void> put = operator_control_->memory().put_scan(*row,
                                                                {.id = 0,
                                                                 .time = memory::now_ms(),
                                                                 .who = "service",
                                                                 .door = {},
                                                                 .action = "result",
                                                                 .subject = row->name,
                                                                 .before = {},
                                                                 .after = row->verdict},
                                                                chosen.places);
  if (!put) log_error(put.error());
  if (put && chosen.written != memory::Evidence{}) {
    if (const Result<void> kept = operator_control_->memory().put_evidence(row->name, chosen.written); !kept)
      log_error(kept.error());
  }
  if (still_held) tell_held(*held);
  words.unlock();
  if (!still_held && !after.goes_on) operator_control_->end_cycle(*row);
  operator_control_->tell_scan(row->name);
  return {
      .waits = still_held,
      .end = {.who = memory::ended_by(*row),
              .told = {.reason_code = row->reason_code, .reason = row->reason, .next_step = row->next_step}}};
}

void Service::bound_black_box() const {
  if (!options_.kept.is_bounded()) return;
  const auto may_go = [&](const std::string& name) {
    const Result<std::optional<memory::Scan>> row = operator_control_->memory().scan(name);
    return row && *row && !(*row)->marked && (*row)->decision != "held" && (*row)->verdict != "working";
  };
  const auto most_bytes = static_cast<std::uint64_t>(options_.keep_refused_gb * 1e9);
  for (const fs::path& file : messages_to_go(options_.out, most_bytes, may_go)) {
    std::error_code error;
    fs::remove(file, error);
    if (error) log_error(fail_errno(Errc::WriteFailed, error.value(), "%.200s", file.c_str()).value());
  }
}

Result<void> Service::make_room() const {
  bound_black_box();
  if (!options_.keep_days && !options_.keep_gb) return {};
  memory::Retention retention;
  if (options_.keep_days) {
    retention.oldest = memory::now_ms() - static_cast<memory::UnixMs>(*options_.keep_days *
                                                                      static_cast<double>(memory::k_day_ms));
  }
  if (options_.keep_gb) retention.most_bytes = static_cast<std::uint64_t>(*options_.keep_gb * 1e9);
  BITELINE_ASSIGN(const std::vector<std::string> go,
                  operator_control_->memory().folders_to_go(retention, options_.out));
  for (const std::string& name : go) {
    // The row first: a folder without one would be taken up again.
    BITELINE_TRY(operator_control_->memory().forget_folder(name, {.id = 0,
                                                                  .time = memory::now_ms(),
                                                                  .who = "service",
                                                                  .door = {},
                                                                  .action = "folder removed",
                                                                  .subject = name,
                                                                  .before = {},
                                                                  .after = {}}));
    std::error_code error;
    fs::remove_all(options_.out / name, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", (options_.out / name).c_str());
  }
  return {};
}

}  // namespace biteline::service
