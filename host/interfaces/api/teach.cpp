// SPDX-License-Identifier: MIT
#include "host/interfaces/api/teach.hpp"

#include <algorithm>
#include <array>

#include "host/interfaces/api/air.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/records/digest/digest.hpp"
#include "host/transfer/library.hpp"

namespace biteline::api {

using memory::Teaching;

namespace {

namespace fs = std::filesystem;

/// Only a page of it is missing where a path was refused.
constexpr const char* k_dry_run_file = "path/tracking.html";

Json work_json(const memory::TaughtWork& work) {
  return {{"scan", or_null(work.scan)},
          {"line_version", work.line_version},
          {"process_sha256", or_null(work.process_sha256)}};
}

Json deed_json(const std::optional<Teaching::Deed>& deed, bool is_run) {
  if (!deed) return nullptr;
  Json json = work_json(deed->work);
  json["who"] = deed->who;
  json["time"] = memory::to_iso(deed->time);
  if (is_run) json["state"] = deed->outcome;
  return json;
}

Json teaching_steps_json(const Teaching& teaching) {
  constexpr std::array k_states{"done", "now", "open"};
  const memory::TeachSteps steps = memory::steps_of(teaching);
  Json list = Json::array();
  for (std::size_t i = 0; i < steps.size(); ++i)
    list.push_back({{"step", memory::k_teach_steps.at(i)},
                    {"state", k_states.at(static_cast<std::size_t>(steps.at(i).is))},
                    {"why", or_null(std::string{steps.at(i).why})}});
  return list;
}

}  // namespace

Json to_json(const Teaching& teaching) {
  const std::optional<memory::TeachStep> step = memory::step_of(teaching);
  Json json = work_json(teaching.work);
  json["id"] = teaching.id;
  json["begun"] = memory::to_iso(teaching.begun);
  json["begun_by"] = teaching.begun_by;
  json["scans_before"] = teaching.scans_before;
  json["process"] = or_null(teaching.process);
  json["process_by"] = or_null(teaching.process_by);
  json["dry_run"] = deed_json(teaching.dry_run, false);
  json["air"] = deed_json(teaching.air, true);
  json["followed"] = deed_json(teaching.followed, false);
  json["model"] = or_null(teaching.model);
  json["ended"] = teaching.ended ? Json(memory::to_iso(*teaching.ended)) : Json{};
  json["ended_by"] = or_null(teaching.ended_by);
  json["ended_how"] = or_null(teaching.ended_how);
  json["step"] = step ? Json(memory::k_teach_steps.at(static_cast<std::size_t>(*step))) : Json{};
  json["steps"] = teaching_steps_json(teaching);
  return json;
}

std::optional<Teaching> TeachRoom::open_locked() {
  Result<std::vector<Teaching>> newest = memory_.teachings(0, 1);
  if (!newest || newest->empty() || newest->front().ended) return std::nullopt;
  return std::move(newest->front());
}

void TeachRoom::put_locked(const Teaching& teaching) {
  // Where it cannot be kept, who looks at it next takes it in again.
  if (const Result<std::int64_t> id = memory_.put_teaching(teaching); id && publish_) {
    Teaching told = teaching;
    told.id = *id;
    publish_("teaching", to_json(told));
  }
}

void TeachRoom::end_locked(Teaching teaching, const char* how, const std::string& who) {
  teaching.ended = memory::now_ms();
  teaching.ended_by = who;
  teaching.ended_how = how;
  put_locked(teaching);
}

void TeachRoom::begin_locked(const std::string& who, memory::UnixMs heard) {
  Teaching teaching;
  teaching.begun = heard;
  teaching.begun_by = who;
  put_locked(teaching);
}

void TeachRoom::begin(const std::string& who, memory::UnixMs heard) {
  const std::lock_guard lock{mutex_};
  if (std::optional<Teaching> open = open_locked()) end_locked(std::move(*open), "replaced", who);
  begin_locked(who, heard);
}

void TeachRoom::begin_or_go_on(const std::string& who, memory::UnixMs heard) {
  const std::lock_guard lock{mutex_};
  if (!open_locked()) begin_locked(who, heard);
}

void TeachRoom::give_up(const std::string& who) {
  const std::lock_guard lock{mutex_};
  if (std::optional<Teaching> open = open_locked()) end_locked(std::move(*open), "given_up", who);
}

bool TeachRoom::give_up(std::int64_t id, const std::string& who) {
  const std::lock_guard lock{mutex_};
  std::optional<Teaching> open = open_locked();
  if (!open || open->id != id) return false;
  end_locked(std::move(*open), "given_up", who);
  return true;
}

Teaching TeachRoom::taken_in_locked(Teaching teaching, const Json& state) const {
  memory::TaughtWork& work = teaching.work;
  const Result<std::string> held = memory_.held_since(teaching.begun);
  const bool is_new = held && !held->empty() && *held != work.scan &&
                      std::ranges::find(teaching.scans_before, *held) == teaching.scans_before.end();
  if (is_new) {
    if (!work.scan.empty()) teaching.scans_before.push_back(work.scan);
    work = {.scan = *held, .line_version = 0, .process_sha256 = {}};
    teaching.verdict.clear();
    teaching.has_path = false;
  }
  if (work.scan.empty()) return teaching;
  const Result<std::optional<memory::Scan>> row = memory_.scan(work.scan);
  const fs::path folder = results_ / work.scan;
  std::error_code error;
  // A folder that was cleared away takes back nothing that was done.
  if (!row || !*row || !fs::is_directory(folder, error)) return teaching;
  work.line_version = (*row)->line_version;
  teaching.verdict = (*row)->verdict;
  teaching.process = (*row)->process;
  work.process_sha256 = digest_of_file(folder / transfer::k_process_file).value_or(std::string{});
  teaching.has_path = fs::exists(folder / k_dry_run_file, error);
  const Json waits = state.value("held", Json{});
  if (waits.is_object() && waits.value("scan", "") == work.scan) {
    const auto by = state.find("process_by");
    teaching.process_by = by != state.end() && by->is_string() ? by->get<std::string>() : std::string{};
  }
  if (teaching.air && teaching.air->work.scan == work.scan && teaching.air->outcome == "begun" &&
      before_air(work.scan) != teaching.air->mark) {
    const Json air = air_json(folder / k_air_folder);
    if (air.is_object()) teaching.air->outcome = air.value("state", "begun");
    if (teaching.air->outcome == "followed") teaching.followed = teaching.air;
  }
  return teaching;
}

std::optional<Teaching> TeachRoom::look_locked(const Json& state) {
  const std::optional<Teaching> open = open_locked();
  if (!open) return std::nullopt;
  Teaching now = taken_in_locked(*open, state);
  if (now != *open) put_locked(now);
  return now;
}

std::optional<Teaching> TeachRoom::look() {
  const Json state = cell_.state();
  const std::lock_guard lock{mutex_};
  return look_locked(state);
}

Result<std::optional<Teaching>> TeachRoom::look_at(std::int64_t id) {
  static_cast<void>(look());
  return memory_.teaching(id);
}

void TeachRoom::chose_process(const std::string& scan, const std::string& who) {
  const Json state = cell_.state();
  const std::lock_guard lock{mutex_};
  std::optional<Teaching> open = look_locked(state);
  if (!open || open->work.scan != scan || open->process_by == who) return;
  open->process_by = who;
  put_locked(*open);
}

std::string TeachRoom::before_air(const std::string& scan) const {
  std::error_code error;
  const fs::file_time_type time = fs::last_write_time(results_ / scan / k_air_folder, error);
  return error ? std::string{} : std::to_string(time.time_since_epoch().count());
}

void TeachRoom::runs_in_air(const std::string& scan, const std::string& who, const std::string& before) {
  const Json state = cell_.state();
  const std::lock_guard lock{mutex_};
  std::optional<Teaching> open = look_locked(state);
  if (!open || open->work.scan != scan) return;
  open->air = Teaching::Deed{
      .work = open->work, .who = who, .time = memory::now_ms(), .outcome = "begun", .mark = before};
  put_locked(*open);
}

Result<Teaching> TeachRoom::saw_dry_run(std::int64_t id, const memory::LogRow& event,
                                        const std::function<bool(const memory::TaughtWork&)>& is) {
  const Json state = cell_.state();
  const std::lock_guard lock{mutex_};
  std::optional<Teaching> open = look_locked(state);
  if (!open || open->id != id) {
    BITELINE_ASSIGN(const std::optional<Teaching> known, memory_.teaching(id));
    if (!known) return fail(Errc::FileNotFound, "teaching %lld", static_cast<long long>(id));
    return fail(Errc::WrongState, "teaching %lld has ended; start anew", static_cast<long long>(id));
  }
  if (open->work.scan.empty() || !open->has_path)
    return fail(Errc::WrongState, "there is no dry run yet; choose a process first");
  if (!is(open->work))
    return fail(Errc::WrongState, "%s has another line or process by now than the one looked at; look again",
                open->work.scan.c_str());
  open->dry_run = Teaching::Deed{.work = open->work, .who = event.who, .time = event.time};
  BITELINE_TRY(memory_.put_teaching(*open, event));
  if (publish_) publish_("teaching", to_json(*open));
  return *open;
}

Result<std::string> TeachRoom::not_run(const std::string& scan, const std::string& process_sha256) {
  static_cast<void>(look());
  BITELINE_ASSIGN(const std::optional<Teaching> teaching, memory_.teaching_of(scan));
  if (!teaching) return std::string{};
  BITELINE_ASSIGN(const std::optional<memory::Scan> row, memory_.scan(scan));
  if (!row) return std::string{};
  if (!teaching->followed) return scan + " was not run in the air yet";
  const std::string_view other =
      memory::other_than(teaching->followed->work,
                         {.scan = scan, .line_version = row->line_version, .process_sha256 = process_sha256});
  if (other.empty()) return std::string{};
  if (other == "scanned_again") return teaching->followed->work.scan + " was run in the air, and not " + scan;
  return "the " + std::string{other == "line_changed" ? "line" : "process"} + " of " + scan +
         " is another one than was run in the air";
}

void TeachRoom::saved(const std::string& scan, const std::string& model, const std::string& who) {
  const std::lock_guard lock{mutex_};
  const Result<std::optional<Teaching>> found = memory_.teaching_of(scan);
  if (!found || !*found) return;
  Teaching teaching = **found;
  teaching.model = model;
  if (teaching.ended) {
    put_locked(teaching);
  } else {
    end_locked(std::move(teaching), "saved", who);
  }
}

}  // namespace biteline::api
