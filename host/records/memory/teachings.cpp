// SPDX-License-Identifier: MIT
// Teachings: their rows, the scans that they were about, and what was done.
#include <algorithm>
#include <array>
#include <utility>

#include "host/records/memory/memory.hpp"

namespace biteline::memory {
namespace {

constexpr const char* k_teaching_columns =
    "id, begun, begun_by, line_version, process, process_sha256, process_by, verdict, has_path, model, "
    "ended, "
    "ended_by, ended_how";

struct NamedDeed {
  const char* name;
  std::optional<Teaching::Deed> Teaching::*deed;
};
constexpr std::array k_deeds{NamedDeed{"dry_run", &Teaching::dry_run}, NamedDeed{"air", &Teaching::air},
                             NamedDeed{"followed", &Teaching::followed}};

Result<void> read_scans(Database& database, Teaching& teaching) {
  BITELINE_ASSIGN(Statement rows,
                  database.prepare("SELECT scan FROM teaching_scans WHERE teaching = ? ORDER BY place"));
  rows.bind(teaching.id);
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) break;
    teaching.scans_before.push_back(rows.text(0));
  }
  if (teaching.scans_before.empty()) return {};
  teaching.work.scan = std::move(teaching.scans_before.back());
  teaching.scans_before.pop_back();
  return {};
}

Result<void> read_deeds(Database& database, Teaching& teaching) {
  BITELINE_ASSIGN(
      Statement rows,
      database.prepare("SELECT deed, scan, line_version, process_sha256, who, time, outcome, mark "
                       "FROM teaching_deeds WHERE teaching = ?"));
  rows.bind(teaching.id);
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return {};
    const std::string name = rows.text(0);
    const auto named = std::ranges::find_if(k_deeds, [&](const NamedDeed& one) { return name == one.name; });
    if (named == k_deeds.end()) continue;
    teaching.*(named->deed) = Teaching::Deed{.work = {.scan = rows.text(1),
                                                      .line_version = static_cast<int>(rows.integer(2)),
                                                      .process_sha256 = rows.text(3)},
                                             .who = rows.text(4),
                                             .time = rows.integer(5),
                                             .outcome = rows.text(6),
                                             .mark = rows.text(7)};
  }
}

/// All of its rows, with what belongs to each.
Result<std::vector<Teaching>> read_all(Database& database, Statement& rows) {
  std::vector<Teaching> all;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) break;
    Teaching one;
    one.id = rows.integer(0);
    one.begun = rows.integer(1);
    one.begun_by = rows.text(2);
    one.work.line_version = static_cast<int>(rows.integer(3));
    one.process = rows.text(4);
    one.work.process_sha256 = rows.text(5);
    one.process_by = rows.text(6);
    one.verdict = rows.text(7);
    one.has_path = rows.integer(8) != 0;
    one.model = rows.text(9);
    if (!rows.is_null(10)) one.ended = rows.integer(10);
    one.ended_by = rows.text(11);
    one.ended_how = rows.text(12);
    all.push_back(std::move(one));
  }
  for (Teaching& one : all) {
    BITELINE_TRY(read_scans(database, one));
    BITELINE_TRY(read_deeds(database, one));
  }
  return all;
}

Result<std::optional<Teaching>> read_one(Database& database, Statement& rows) {
  BITELINE_ASSIGN(std::vector<Teaching> all, read_all(database, rows));
  if (all.empty()) return std::optional<Teaching>{};
  return std::optional{std::move(all.front())};
}

Result<void> put_parts(Database& database, const Teaching& teaching, std::int64_t id) {
  for (const char* table : {"teaching_scans", "teaching_deeds"}) {
    BITELINE_ASSIGN(Statement gone,
                    database.prepare(std::string{"DELETE FROM "} + table + " WHERE teaching = ?"));
    BITELINE_TRY(gone.bind(id).run());
  }
  std::vector<std::string> scans = teaching.scans_before;
  if (!teaching.work.scan.empty()) scans.push_back(teaching.work.scan);
  BITELINE_ASSIGN(Statement scan,
                  database.prepare("INSERT INTO teaching_scans (teaching, place, scan) VALUES (?, ?, ?)"));
  for (std::size_t place = 0; place < scans.size(); ++place) {
    scan.again();
    BITELINE_TRY(scan.bind(id).bind(static_cast<std::int64_t>(place)).bind(scans[place]).run());
  }
  BITELINE_ASSIGN(Statement deed,
                  database.prepare("INSERT INTO teaching_deeds (teaching, deed, scan, line_version, "
                                   "process_sha256, who, time, outcome, mark) VALUES (?,?,?,?,?,?,?,?,?)"));
  for (const NamedDeed& named : k_deeds) {
    const std::optional<Teaching::Deed>& done = teaching.*(named.deed);
    if (!done) continue;
    deed.again();
    deed.bind(id).bind(named.name).bind(done->work.scan).bind(done->work.line_version);
    deed.bind(done->work.process_sha256).bind(done->who).bind(done->time);
    BITELINE_TRY(deed.bind(done->outcome).bind(done->mark).run());
  }
  return {};
}

}  // namespace

Result<std::int64_t> Memory::put_teaching(const Teaching& teaching, const std::optional<LogRow>& event) {
  const std::lock_guard lock{*mutex_};
  std::int64_t id = teaching.id;
  BITELINE_TRY(database_->transaction([&]() -> Result<void> {
    BITELINE_ASSIGN(
        Statement put,
        database_->prepare(
            "INSERT INTO teachings (id, begun, begun_by, line_version, process, process_sha256, process_by, "
            "verdict, has_path, model, ended, ended_by, ended_how) VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?) "
            "ON CONFLICT (id) DO UPDATE SET line_version = excluded.line_version, process = "
            "excluded.process, process_sha256 = excluded.process_sha256, process_by = excluded.process_by, "
            "verdict = excluded.verdict, has_path = excluded.has_path, model = excluded.model, ended = "
            "excluded.ended, ended_by = excluded.ended_by, ended_how = excluded.ended_how"));
    if (id == 0) {
      put.bind_null();
    } else {
      put.bind(id);
    }
    put.bind(teaching.begun).bind(teaching.begun_by).bind(teaching.work.line_version);
    put.bind(teaching.process).bind(teaching.work.process_sha256).bind(teaching.process_by);
    put.bind(teaching.verdict).bind(teaching.has_path ? 1 : 0).bind(teaching.model);
    BITELINE_TRY(put.bind(teaching.ended).bind(teaching.ended_by).bind(teaching.ended_how).run());
    if (id == 0) id = database_->last_id();
    BITELINE_TRY(put_parts(*database_, teaching, id));
    return event ? add_log(*event) : Result<void>{};
  }));
  return id;
}

Result<std::vector<Teaching>> Memory::teachings(std::int64_t before_id, int limit) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement rows, database_->prepare(std::string{"SELECT "} + k_teaching_columns +
                                                     " FROM teachings WHERE ?1 = 0 OR id < ?1 "
                                                     "ORDER BY id DESC LIMIT ?2"));
  rows.bind(before_id).bind(std::clamp(limit, 1, k_most_scans + 1));
  return read_all(*database_, rows);
}

Result<std::optional<Teaching>> Memory::teaching(std::int64_t id) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement row, database_->prepare(std::string{"SELECT "} + k_teaching_columns +
                                                    " FROM teachings WHERE id = ?"));
  row.bind(id);
  return read_one(*database_, row);
}

Result<std::optional<Teaching>> Memory::teaching_of(const std::string& scan) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(
      Statement row,
      database_->prepare(std::string{"SELECT "} + k_teaching_columns +
                         " FROM teachings WHERE ended_how IN ('', 'saved') AND id IN (SELECT "
                         "teaching FROM teaching_scans WHERE scan = ?) ORDER BY id DESC LIMIT 1"));
  row.bind(scan);
  return read_one(*database_, row);
}

Result<std::string> Memory::held_since(UnixMs time) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement row, database_->prepare("SELECT name FROM scans WHERE decision = 'held' AND time "
                                                    ">= ? ORDER BY id DESC LIMIT 1"));
  row.bind(time);
  BITELINE_ASSIGN(const bool found, row.step());
  return found ? row.text(0) : std::string{};
}

}  // namespace biteline::memory
