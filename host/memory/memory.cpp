// SPDX-License-Identifier: MIT
#include "host/memory/memory.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <limits>
#include <utility>
#include <variant>

#include "host/memory/schema.hpp"

namespace biteline::memory {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_scan_columns =
    "id, name, time, model, model_probability, verdict, reason_code, length_mm, confidence, u95_mm, "
    "weak_stretches, scan_s, line_s, cycle_s, operator, process, decision, decided_by, decided_at, sent, "
    "followed, "
    "line_version, marked, reason, next_step, why";
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
  return scan;
}

/// A name that is there keeps its id and its mark.
constexpr const char* k_put_scan = R"sql(
INSERT INTO scans (name, time, model, model_probability, verdict, reason_code, length_mm, confidence, u95_mm,
  weak_stretches, scan_s, line_s, cycle_s, operator, process, decision, decided_by, decided_at, sent, followed,
  line_version, marked)
VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)
ON CONFLICT (name) DO UPDATE SET time = excluded.time, model = excluded.model,
  model_probability = excluded.model_probability, verdict = excluded.verdict, reason_code = excluded.reason_code,
  length_mm = excluded.length_mm, confidence = excluded.confidence, u95_mm = excluded.u95_mm,
  weak_stretches = excluded.weak_stretches, scan_s = excluded.scan_s, line_s = excluded.line_s,
  cycle_s = excluded.cycle_s, operator = excluded.operator, process = excluded.process,
  decision = excluded.decision, decided_by = excluded.decided_by, decided_at = excluded.decided_at,
  sent = excluded.sent, followed = excluded.followed, line_version = excluded.line_version
)sql";

/// " WHERE ..." of a filter; its values are bound in the same order.
struct Where {
  std::string sql;
  std::vector<std::variant<std::int64_t, std::string>> values;

  void add(const std::string& condition, std::variant<std::int64_t, std::string> value) {
    sql += (sql.empty() ? " WHERE " : " AND ") + condition;
    values.push_back(std::move(value));
  }
  void bind_to(Statement& statement) const {
    for (const auto& value : values) {
      if (const auto* number = std::get_if<std::int64_t>(&value)) {
        statement.bind(*number);
      } else {
        statement.bind(std::string_view{std::get<std::string>(value)});
      }
    }
  }
};

Where where_of(const ScanFilter& filter) {
  Where where;
  if (filter.from) where.add("time >= ?", *filter.from);
  if (filter.to) where.add("time < ?", *filter.to);
  if (!filter.model.empty()) where.add("model = ?", filter.model);
  if (!filter.verdict.empty()) where.add("verdict = ?", filter.verdict);
  if (!filter.reason_code.empty()) where.add("reason_code = ?", filter.reason_code);
  return where;
}

Result<std::int64_t> id_of(Database& database, const std::string& name) {
  BITELINE_ASSIGN(Statement row, database.prepare("SELECT id FROM scans WHERE name = ?"));
  row.bind(name);
  BITELINE_ASSIGN(const bool found, row.step());
  if (!found) return fail(Errc::FileNotFound, "scan '%.80s' in the memory", name.c_str());
  return row.integer(0);
}

std::optional<double> median(std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

struct Bucket {
  Trend trend;
  double length_mm{0};
  std::int64_t lengths{0};
  std::vector<double> u95_mm, cycle_s;

  void add(const Statement& row) {
    ++trend.scans;
    const std::string verdict = row.text(1);
    trend.ok += verdict == "ok" ? 1 : 0;
    trend.amber += verdict == "amber" ? 1 : 0;
    trend.refused += verdict == "refused" ? 1 : 0;
    trend.failed += verdict == "failed" ? 1 : 0;
    if (!row.is_null(2)) {
      length_mm += row.number(2);
      ++lengths;
    }
    if (!row.is_null(3)) u95_mm.push_back(row.number(3));
    if (!row.is_null(4)) cycle_s.push_back(row.number(4));
  }
  Trend close() {
    if (lengths > 0) trend.mean_length_mm = length_mm / static_cast<double>(lengths);
    trend.median_u95_mm = median(u95_mm);
    trend.median_cycle_s = median(cycle_s);
    return trend;
  }
};

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

UnixMs now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::string to_iso(UnixMs time) {
  const UnixMs ms = ((time % 1000) + 1000) % 1000;
  const auto seconds = static_cast<std::time_t>((time - ms) / 1000);
  std::tm parts{};
  char day[32] = {};
  std::strftime(day, sizeof day, "%Y-%m-%dT%H:%M:%S", gmtime_r(&seconds, &parts));
  char text[48] = {};
  std::snprintf(text, sizeof text, "%s.%03dZ", day, static_cast<int>(ms));
  return text;
}

std::optional<UnixMs> from_iso(const std::string& iso) {
  std::tm parts{};
  int ms = 0;
  int taken = 0;
  const char* const text = iso.c_str();
  const auto length = static_cast<int>(iso.size());
  const bool day_only =
      std::sscanf(text, "%4d-%2d-%2d%n", &parts.tm_year, &parts.tm_mon, &parts.tm_mday, &taken) == 3;
  if (!day_only) return std::nullopt;
  if (taken != length) {
    int more = 0;
    if (std::sscanf(text + taken, "T%2d:%2d:%2d%n", &parts.tm_hour, &parts.tm_min, &parts.tm_sec, &more) != 3)
      return std::nullopt;
    taken += more;
    more = 0;
    if (taken < length && std::sscanf(text + taken, ".%3d%n", &ms, &more) == 1) taken += more;
    if (taken < length && text[taken] == 'Z') ++taken;
    if (taken != length) return std::nullopt;
  }
  const bool possible = parts.tm_year >= 1970 && parts.tm_year <= 9999 && parts.tm_mon >= 1 &&
                        parts.tm_mon <= 12 && parts.tm_mday >= 1 && parts.tm_mday <= 31 &&
                        parts.tm_hour >= 0 && parts.tm_hour < 24 && parts.tm_min >= 0 && parts.tm_min < 60 &&
                        parts.tm_sec >= 0 && parts.tm_sec <= 60 && ms >= 0;
  if (!possible) return std::nullopt;
  parts.tm_year -= 1900;
  parts.tm_mon -= 1;
  return static_cast<UnixMs>(::timegm(&parts)) * 1000 + ms;
}

Memory::Memory(Database database)
    : database_{std::make_unique<Database>(std::move(database))}, mutex_{std::make_unique<std::mutex>()} {}

Result<Memory> Memory::open(const fs::path& file) {
  BITELINE_ASSIGN(Database database, Database::open(file, Database::Access::ReadWrite));
  BITELINE_TRY(raise_schema(database));
  return Memory{std::move(database)};
}

Result<Memory> Memory::open_to_read(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error))
    return fail(Errc::FileNotFound, "%.200s: no memory; a biteline-host with this --out makes one",
                file.c_str());
  BITELINE_ASSIGN(Database database, Database::open(file, Database::Access::ReadOnly));
  BITELINE_TRY(check_schema(database));
  return Memory{std::move(database)};
}

Result<void> Memory::add_log(const LogRow& row) {
  BITELINE_ASSIGN(Statement insert,
                  database_->prepare("INSERT INTO log (time, who, door, action, subject, before, after) "
                                     "VALUES (?, ?, ?, ?, ?, ?, ?)"));
  insert.bind(row.time != 0 ? row.time : now_ms()).bind(row.who).bind(row.door).bind(row.action);
  return insert.bind(row.subject).bind(row.before).bind(row.after).run();
}

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
  scan.versions = row.text(26);
  scan.details = row.text(27);
  return std::optional<Scan>{std::move(scan)};
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

Result<Trends> Memory::trends(const ScanFilter& filter, UnixMs bucket_ms) const {
  const std::lock_guard lock{*mutex_};
  Trends trends;
  const Where where = where_of(filter);
  // In the order of an index that has all of these columns: one GROUP BY would sort every row first.
  BITELINE_ASSIGN(Statement rows,
                  database_->prepare("SELECT time, verdict, length_mm, u95_mm, cycle_s FROM scans" +
                                     where.sql + " ORDER BY time"));
  where.bind_to(rows);
  Bucket bucket;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) break;
    const UnixMs begin = rows.integer(0) / bucket_ms * bucket_ms;
    if (bucket.trend.scans > 0 && begin != bucket.trend.begin) {
      trends.buckets.push_back(bucket.close());
      bucket = Bucket{};
    }
    bucket.trend.begin = begin;
    bucket.add(rows);
  }
  if (bucket.trend.scans > 0) trends.buckets.push_back(bucket.close());
  Where refused = where;
  refused.add("reason_code > ?", std::string{});
  BITELINE_ASSIGN(Statement reasons, database_->prepare("SELECT reason_code, count(*) FROM scans" +
                                                        refused.sql + " GROUP BY 1 ORDER BY 2 DESC, 1"));
  refused.bind_to(reasons);
  while (true) {
    BITELINE_ASSIGN(const bool row, reasons.step());
    if (!row) return trends;
    trends.reasons.push_back({.reason_code = reasons.text(0), .scans = reasons.integer(1)});
  }
}

Result<PlaceSums> Memory::place_sums(const std::string& model, std::optional<UnixMs> from,
                                     std::optional<UnixMs> to) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement rows,
                  database_->prepare("SELECT places FROM scan_places WHERE model = ? AND time >= ? "
                                     "AND time < ?"));
  rows.bind(model).bind(from.value_or(0)).bind(to.value_or(std::numeric_limits<std::int64_t>::max()));
  PlaceSums sums;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return sums;
    const std::span<const std::uint8_t> bytes = rows.bytes(0);
    if (bytes.size() != sizeof(Places)) continue;
    Places places{};
    std::memcpy(places.data(), bytes.data(), sizeof places);
    ++sums.scans;
    for (std::size_t i = 0; i < k_places; ++i) {
      const double mm = places[i];
      sums.sum_mm[i] += mm;
      sums.sum_mm2[i] += mm * mm;
    }
  }
}

Result<void> Memory::log(const LogRow& row) {
  const std::lock_guard lock{*mutex_};
  return add_log(row);
}

Result<std::vector<LogRow>> Memory::log_rows(std::int64_t before_id, int limit, std::optional<UnixMs> from,
                                             std::optional<UnixMs> to) const {
  const std::lock_guard lock{*mutex_};
  constexpr std::int64_t k_ever = std::numeric_limits<std::int64_t>::max();
  BITELINE_ASSIGN(
      Statement rows,
      database_->prepare("SELECT id, time, who, door, action, subject, before, after FROM log WHERE id < ? "
                         "AND time >= ? AND time < ? ORDER BY id DESC LIMIT ?"));
  rows.bind(before_id > 0 ? before_id : k_ever).bind(from.value_or(0)).bind(to.value_or(k_ever));
  rows.bind(std::clamp(limit, 1, k_most_scans + 1));
  std::vector<LogRow> log;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return log;
    log.push_back({.id = rows.integer(0),
                   .time = rows.integer(1),
                   .who = rows.text(2),
                   .door = rows.text(3),
                   .action = rows.text(4),
                   .subject = rows.text(5),
                   .before = rows.text(6),
                   .after = rows.text(7)});
  }
}

Result<void> Memory::put_user(const User& user, const LogRow& event) {
  const std::lock_guard lock{*mutex_};
  return database_->transaction([&]() -> Result<void> {
    BITELINE_ASSIGN(
        Statement put,
        database_->prepare(
            "INSERT INTO users (name, role, password_hash, created, enabled) VALUES (?, ?, ?, ?, ?) "
            "ON CONFLICT (name) DO UPDATE SET role = excluded.role, password_hash = "
            "excluded.password_hash, enabled = excluded.enabled"));
    BITELINE_TRY(put.bind(user.name)
                     .bind(user.role)
                     .bind(user.password_hash)
                     .bind(user.created)
                     .bind(user.enabled ? 1 : 0)
                     .run());
    // Whoever has another role or password logs in again.
    BITELINE_ASSIGN(Statement sessions, database_->prepare("DELETE FROM sessions WHERE user = ?"));
    BITELINE_TRY(sessions.bind(user.name).run());
    return add_log(event);
  });
}

Result<void> Memory::note_login(const std::string& name, UnixMs time) {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement update, database_->prepare("UPDATE users SET last_login = ? WHERE name = ?"));
  return update.bind(time).bind(name).run();
}

Result<void> Memory::remove_user(const std::string& name, const LogRow& event) {
  const std::lock_guard lock{*mutex_};
  return database_->transaction([&]() -> Result<void> {
    BITELINE_ASSIGN(Statement user, database_->prepare("DELETE FROM users WHERE name = ?"));
    BITELINE_TRY(user.bind(name).run());
    if (database_->changes() == 0) return fail(Errc::FileNotFound, "user '%.80s'", name.c_str());
    BITELINE_ASSIGN(Statement sessions, database_->prepare("DELETE FROM sessions WHERE user = ?"));
    BITELINE_TRY(sessions.bind(name).run());
    return add_log(event);
  });
}

Result<std::vector<User>> Memory::users() const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(
      Statement rows,
      database_->prepare(
          "SELECT name, role, password_hash, created, enabled, last_login FROM users ORDER BY name"));
  std::vector<User> users;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return users;
    User user{.name = rows.text(0),
              .role = rows.text(1),
              .password_hash = rows.text(2),
              .created = rows.integer(3)};
    user.enabled = rows.integer(4) != 0;
    if (!rows.is_null(5)) user.last_login = rows.integer(5);
    users.push_back(std::move(user));
  }
}

Result<void> Memory::put_session(const Session& session, const LogRow& event) {
  const std::lock_guard lock{*mutex_};
  return database_->transaction([&]() -> Result<void> {
    BITELINE_ASSIGN(
        Statement put,
        database_->prepare("INSERT OR REPLACE INTO sessions (token_hash, user, role, created, expires) "
                           "VALUES (?, ?, ?, ?, ?)"));
    put.bind(session.token_hash)
        .bind(session.user)
        .bind(session.role)
        .bind(session.created)
        .bind(session.expires);
    BITELINE_TRY(put.run());
    return add_log(event);
  });
}

Result<std::optional<Session>> Memory::session(const std::string& token_hash) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement row,
                  database_->prepare("SELECT token_hash, user, role, created, expires FROM sessions "
                                     "WHERE token_hash = ?"));
  row.bind(token_hash);
  BITELINE_ASSIGN(const bool found, row.step());
  if (!found) return std::optional<Session>{};
  return std::optional<Session>{Session{.token_hash = row.text(0),
                                        .user = row.text(1),
                                        .role = row.text(2),
                                        .created = row.integer(3),
                                        .expires = row.integer(4)}};
}

Result<void> Memory::remove_session(const std::string& token_hash, const LogRow& event) {
  const std::lock_guard lock{*mutex_};
  return database_->transaction([&]() -> Result<void> {
    BITELINE_ASSIGN(Statement row, database_->prepare("DELETE FROM sessions WHERE token_hash = ?"));
    BITELINE_TRY(row.bind(token_hash).run());
    return add_log(event);
  });
}

Result<void> Memory::remove_sessions_before(UnixMs time) {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement rows, database_->prepare("DELETE FROM sessions WHERE expires < ?"));
  return rows.bind(time).run();
}

Result<std::optional<std::string>> Memory::setting(const std::string& key) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement row, database_->prepare("SELECT value FROM settings WHERE key = ?"));
  row.bind(key);
  BITELINE_ASSIGN(const bool found, row.step());
  if (!found) return std::optional<std::string>{};
  return std::optional<std::string>{row.text(0)};
}

Result<void> Memory::put_setting(const std::string& key, const std::string& value, const LogRow& event) {
  const std::lock_guard lock{*mutex_};
  return database_->transaction([&]() -> Result<void> {
    BITELINE_ASSIGN(Statement put,
                    database_->prepare("INSERT OR REPLACE INTO settings (key, value) VALUES (?, ?)"));
    BITELINE_TRY(put.bind(key).bind(value).run());
    return add_log(event);
  });
}

Result<void> Memory::copy_to(const fs::path& target) const {
  const std::lock_guard lock{*mutex_};
  return database_->copy_to(target);
}

}  // namespace biteline::memory
