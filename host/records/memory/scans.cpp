// SPDX-License-Identifier: MIT
// Scans: their rows, their folders.
#include <algorithm>
#include <utility>

#include "host/records/memory/memory.hpp"
#include "host/records/memory/scan_filter.hpp"

namespace biteline::memory {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_scan_columns =
    "id, name, time, model, model_probability, verdict, reason_code, length_mm, confidence, u95_mm, "
    "weak_stretches, scan_s, line_s, cycle_s, operator, process, decision, decided_by, decided_at, sent, "
    "followed, "
    "line_version, marked, reason, next_step, why, part, foot, size, tip_bound_mm, work, "
    "work_reworked, work_missing_mm, work_narrow, work_wide, work_beside, work_doubled, follows";
constexpr const char* k_scan_tables = " FROM scans LEFT JOIN scan_texts ON scan = id";

Scan scan_of(const Statement& row) {
  Scan scan;
  scan.name = row.text(1);
  scan.time = row.integer(2);
  scan.model = row.text(3);
  scan.model_probability = row.number_if(4);
  scan.verdict = row.text(5);
  scan.reason_code = row.text(6);
  scan.length_mm = row.number_if(7);
  scan.confidence = row.number_if(8);
  scan.u95_mm = row.number_if(9);
  scan.weak_stretches = static_cast<int>(row.integer(10));
  scan.scan_s = row.number_if(11);
  scan.line_s = row.number_if(12);
  scan.cycle_s = row.number_if(13);
  scan.operator_name = row.text(14);
  scan.process = row.text(15);
  scan.decision = row.text(16);
  scan.decided_by = row.text(17);
  if (!row.is_null(18)) scan.decided_at = row.integer(18);
  scan.sent = row.integer(19) != 0;
  if (!row.is_null(20)) scan.followed = row.integer(20) != 0;
  scan.line_version = static_cast<int>(row.integer(21));
  scan.marked = row.integer(22) != 0;
  scan.reason = row.text(23);
  scan.next_step = row.text(24);
  scan.why = row.text(25);
  scan.part = row.text(26);
  scan.foot = row.text(27);
  scan.size = row.text(28);
  scan.tip_bound_mm = row.number_if(29);
  scan.work = {.verdict = row.text(30),
               .reworked = row.integer(31) != 0,
               .missing_mm = row.number_if(32),
               .narrow = static_cast<int>(row.integer(33)),
               .wide = static_cast<int>(row.integer(34)),
               .beside = static_cast<int>(row.integer(35)),
               .doubled = static_cast<int>(row.integer(36))};
  scan.follows = row.text(37);
  return scan;
}

/// A name that is there keeps its id and its mark.
constexpr const char* k_put_scan = R"sql(
INSERT INTO scans (name, time, model, model_probability, verdict, reason_code, length_mm, confidence, u95_mm,
  weak_stretches, scan_s, line_s, cycle_s, operator, process, decision, decided_by, decided_at, sent, followed,
  line_version, marked, part, foot, size, tip_bound_mm, work, work_reworked, work_missing_mm, work_narrow,
  work_wide, work_beside, work_doubled, follows)
VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)
ON CONFLICT (name) DO UPDATE SET time = excluded.time, model = excluded.model,
  model_probability = excluded.model_probability, verdict = excluded.verdict, reason_code = excluded.reason_code,
  length_mm = excluded.length_mm, confidence = excluded.confidence, u95_mm = excluded.u95_mm,
  weak_stretches = excluded.weak_stretches, scan_s = excluded.scan_s, line_s = excluded.line_s,
  cycle_s = excluded.cycle_s, operator = excluded.operator, process = excluded.process,
  decision = excluded.decision, decided_by = excluded.decided_by, decided_at = excluded.decided_at,
  sent = excluded.sent, followed = excluded.followed, line_version = excluded.line_version,
  part = excluded.part, foot = excluded.foot, size = excluded.size,
  tip_bound_mm = excluded.tip_bound_mm, work = excluded.work, work_reworked = excluded.work_reworked,
  work_missing_mm = excluded.work_missing_mm, work_narrow = excluded.work_narrow,
  work_wide = excluded.work_wide, work_beside = excluded.work_beside, work_doubled = excluded.work_doubled,
  follows = excluded.follows
)sql";

Result<std::int64_t> id_of(Database& database, const std::string& name) {
  BITELINE_ASSIGN(Statement row, database.prepare("SELECT id FROM scans WHERE name = ?"));
  row.bind(name);
  BITELINE_ASSIGN(const bool found, row.step());
  if (!found) return fail(Errc::FileNotFound, "scan '%.80s' in the memory", name.c_str());
  return row.integer(0);
}

std::uint64_t bytes_below(const fs::path& folder) {
  std::uint64_t bytes = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator at{folder, error}, end; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    if (at->is_regular_file(ignored)) bytes += at->file_size(ignored);
  }
  return bytes;
}

}  // namespace

Result<void> Memory::put_scan(const Scan& scan, const LogRow& event, const std::optional<Places>& places) {
  const std::lock_guard lock{*mutex_};
  return database_->transaction([&]() -> Result<void> {
    BITELINE_ASSIGN(Statement put, database_->prepare(k_put_scan));
    put.bind(scan.name).bind(scan.time).bind(scan.model).bind(scan.model_probability).bind(scan.verdict);
    put.bind(scan.reason_code).bind(scan.length_mm).bind(scan.confidence).bind(scan.u95_mm);
    put.bind(scan.weak_stretches).bind(scan.scan_s).bind(scan.line_s).bind(scan.cycle_s);
    put.bind(scan.operator_name).bind(scan.process).bind(scan.decision).bind(scan.decided_by);
    put.bind(scan.decided_at).bind(scan.sent ? 1 : 0);
    if (scan.followed) {
      put.bind(*scan.followed ? 1 : 0);
    } else {
      put.bind_null();
    }
    put.bind(scan.line_version).bind(scan.marked ? 1 : 0);
    put.bind(scan.part).bind(scan.foot).bind(scan.size).bind(scan.tip_bound_mm);
    put.bind(scan.work.verdict).bind(scan.work.reworked ? 1 : 0).bind(scan.work.missing_mm);
    put.bind(scan.work.narrow).bind(scan.work.wide).bind(scan.work.beside).bind(scan.work.doubled);
    put.bind(scan.follows);
    BITELINE_TRY(put.run());
    BITELINE_ASSIGN(const std::int64_t id, id_of(*database_, scan.name));
    BITELINE_ASSIGN(Statement texts,
                    database_->prepare("INSERT OR REPLACE INTO scan_texts (scan, reason, next_step, why, "
                                       "versions, details) VALUES (?, ?, ?, ?, ?, ?)"));
    BITELINE_TRY(texts.bind(id)
                     .bind(scan.reason)
                     .bind(scan.next_step)
                     .bind(scan.why)
                     .bind(scan.versions)
                     .bind(scan.details)
                     .run());
    if (places) {
      BITELINE_ASSIGN(Statement put_places,
                      database_->prepare("INSERT OR REPLACE INTO scan_places (scan, model, time, places) "
                                         "VALUES (?, ?, ?, ?)"));
      const std::span bytes{reinterpret_cast<const std::uint8_t*>(places->data()), sizeof(Places)};
      BITELINE_TRY(put_places.bind(id).bind(scan.model).bind(scan.time).bind(bytes).run());
    }
    BITELINE_ASSIGN(Statement post, database_->prepare("INSERT INTO outbox (scan) VALUES (?)"));
    BITELINE_TRY(post.bind(id).run());
    return add_log(event);
  });
}

Result<std::optional<Scan>> Memory::scan(const std::string& name) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement row,
                  database_->prepare(std::string{"SELECT "} + k_scan_columns + ", versions, details" +
                                     k_scan_tables + " WHERE name = ?"));
  row.bind(name);
  BITELINE_ASSIGN(const bool found, row.step());
  if (!found) return std::optional<Scan>{};
  Scan scan = scan_of(row);
  scan.versions = row.text(38);
  scan.details = row.text(39);
  return std::optional<Scan>{std::move(scan)};
}

Result<void> Memory::put_evidence(const std::string& scan, const Evidence& evidence) {
  const std::lock_guard lock{*mutex_};
  return database_->transaction([&]() -> Result<void> {
    BITELINE_ASSIGN(const std::int64_t id, id_of(*database_, scan));
    BITELINE_ASSIGN(Statement put,
                    database_->prepare("INSERT OR REPLACE INTO scan_evidence (scan, line, cloud, process, "
                                       "report) VALUES (?, ?, ?, ?, ?)"));
    return put.bind(id)
        .bind(evidence.line)
        .bind(evidence.cloud)
        .bind(evidence.process)
        .bind(evidence.report)
        .run();
  });
}

Result<std::optional<Evidence>> Memory::evidence(const std::string& scan) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(
      Statement row,
      database_->prepare("SELECT e.line, e.cloud, e.process, e.report FROM scan_evidence e JOIN scans ON "
                         "scan = id WHERE name = ?"));
  row.bind(scan);
  BITELINE_ASSIGN(const bool found, row.step());
  if (!found) return std::optional<Evidence>{};
  return std::optional{
      Evidence{.line = row.text(0), .cloud = row.text(1), .process = row.text(2), .report = row.text(3)}};
}

Result<ScanPage> Memory::scans(const ScanFilter& filter) const {
  const std::lock_guard lock{*mutex_};
  Where where = where_of(filter);
  if (filter.before_id > 0) where.add("id < ?", filter.before_id);
  const int limit = std::clamp(filter.limit, 1, k_most_scans);
  BITELINE_ASSIGN(Statement rows, database_->prepare(std::string{"SELECT "} + k_scan_columns + k_scan_tables +
                                                     where.sql + " ORDER BY id DESC LIMIT ?"));
  where.bind_to(rows);
  rows.bind(limit + 1);
  ScanPage page;
  std::int64_t last_id = 0;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return page;
    if (static_cast<int>(page.scans.size()) == limit) {
      page.next_id = last_id;
      return page;
    }
    last_id = rows.integer(0);
    page.scans.push_back(scan_of(rows));
  }
}

Result<std::optional<Scan>> Memory::sent_before(const std::string& part, const std::string& scan) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement row,
                  database_->prepare(std::string{"SELECT "} + k_scan_columns + k_scan_tables +
                                     " WHERE part <> '' AND part = ? AND name <> ? AND sent <> 0 "
                                     "ORDER BY id DESC LIMIT 1"));
  row.bind(part).bind(scan);
  BITELINE_ASSIGN(const bool found, row.step());
  return found ? std::optional{scan_of(row)} : std::nullopt;
}

Result<void> Memory::mark(const std::string& name, bool marked, const LogRow& event) {
  const std::lock_guard lock{*mutex_};
  return database_->transaction([&]() -> Result<void> {
    BITELINE_ASSIGN(const std::int64_t id, id_of(*database_, name));
    BITELINE_ASSIGN(Statement update, database_->prepare("UPDATE scans SET marked = ? WHERE id = ?"));
    BITELINE_TRY(update.bind(marked ? 1 : 0).bind(id).run());
    return add_log(event);
  });
}

Result<std::vector<std::string>> Memory::folders_to_go(const Retention& retention,
                                                       const fs::path& results) const {
  struct Folder {
    std::string name;
    UnixMs time{0};
    std::uint64_t bytes{0};
    bool marked{false};
  };
  std::vector<Folder> folders;
  {
    const std::lock_guard lock{*mutex_};
    BITELINE_ASSIGN(Statement rows,
                    database_->prepare("SELECT name, time, marked FROM scans WHERE folder_gone = 0 "
                                       "AND decision <> 'held' ORDER BY time, id"));
    while (true) {
      BITELINE_ASSIGN(const bool row, rows.step());
      if (!row) break;
      folders.push_back({.name = rows.text(0), .time = rows.integer(1), .marked = rows.integer(2) != 0});
    }
  }
  std::uint64_t kept = 0;
  if (retention.most_bytes) {
    for (Folder& folder : folders) kept += folder.bytes = bytes_below(results / folder.name);
  }
  std::vector<std::string> go;
  for (const Folder& folder : folders) {
    const bool old = retention.oldest && folder.time < *retention.oldest;
    const bool too_much = retention.most_bytes && kept > *retention.most_bytes;
    if (folder.marked || (!old && !too_much)) continue;
    kept -= std::min(kept, folder.bytes);
    go.push_back(folder.name);
  }
  return go;
}

Result<void> Memory::forget_folder(const std::string& name, const LogRow& event) {
  const std::lock_guard lock{*mutex_};
  return database_->transaction([&]() -> Result<void> {
    BITELINE_ASSIGN(const std::int64_t id, id_of(*database_, name));
    BITELINE_ASSIGN(Statement update,
                    database_->prepare("UPDATE scans SET folder_gone = 1 WHERE id = ? AND marked = 0"));
    BITELINE_TRY(update.bind(id).run());
    return add_log(event);
  });
}

}  // namespace biteline::memory
