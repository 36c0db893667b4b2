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

constexpr UnixMs k_day_ms = 86'400'000;

constexpr const char* k_scan_columns =
    "id, name, time, model, model_probability, verdict, reason_code, length_mm, confidence, u95_mm, "
    "weak_stretches, scan_s, line_s, cycle_s, operator, process, approval, approved_by, approved_at, "
    "followed, "
    "marked";

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
  scan.approval = row.text(16);
  scan.approved_by = row.text(17);
  if (!row.is_null(18)) scan.approved_at = row.integer(18);
  scan.followed = row.text(19);
  scan.marked = row.integer(20) != 0;
  return scan;
}

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

std::string day_text(std::int64_t day) {
  return to_iso(day * k_day_ms).substr(0, 10);
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
    BITELINE_ASSIGN(
        Statement put,
        database_->prepare(
            "INSERT INTO scans (name, time, model, model_probability, verdict, reason_code, length_mm, "
            "confidence, "
            "u95_mm, weak_stretches, scan_s, line_s, cycle_s, operator, process, approval, approved_by, "
            "approved_at, followed, marked) VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?) "
            "ON CONFLICT (name) DO UPDATE SET time = excluded.time, model = excluded.model, "
            "model_probability = "
            "excluded.model_probability, verdict = excluded.verdict, reason_code = excluded.reason_code, "
            "length_mm = excluded.length_mm, confidence = excluded.confidence, u95_mm = excluded.u95_mm, "
            "weak_stretches = excluded.weak_stretches, scan_s = excluded.scan_s, line_s = excluded.line_s, "
            "cycle_s = excluded.cycle_s, operator = excluded.operator, process = excluded.process, approval "
            "= "
            "excluded.approval, approved_by = excluded.approved_by, approved_at = excluded.approved_at, "
            "followed = "
            "excluded.followed"));
    put.bind(scan.name).bind(scan.time).bind(scan.model).bind(scan.model_probability).bind(scan.verdict);
    put.bind(scan.reason_code).bind(scan.length_mm).bind(scan.confidence).bind(scan.u95_mm);
    put.bind(scan.weak_stretches).bind(scan.scan_s).bind(scan.line_s).bind(scan.cycle_s);
    put.bind(scan.operator_name).bind(scan.process).bind(scan.approval).bind(scan.approved_by);
    put.bind(scan.approved_at).bind(scan.followed).bind(scan.marked ? 1 : 0);
    BITELINE_TRY(put.run());
    BITELINE_ASSIGN(const std::int64_t id, id_of(*database_, scan.name));
    BITELINE_ASSIGN(Statement texts,
                    database_->prepare("INSERT OR REPLACE INTO scan_texts (scan, reason, versions, details) "
                                       "VALUES (?, ?, ?, ?)"));
    BITELINE_TRY(texts.bind(id).bind(scan.reason).bind(scan.versions).bind(scan.details).run());
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
                  database_->prepare(std::string{"SELECT "} + k_scan_columns +
                                     ", reason, versions, details FROM scans LEFT JOIN scan_texts "
                                     "ON scan = id WHERE name = ?"));
  row.bind(name);
  BITELINE_ASSIGN(const bool found, row.step());
  if (!found) return std::optional<Scan>{};
  Scan scan = scan_of(row);
  scan.reason = row.text(21);
  scan.versions = row.text(22);
  scan.details = row.text(23);
  return std::optional<Scan>{std::move(scan)};
}

Result<ScanPage> Memory::scans(const ScanFilter& filter) const {
  const std::lock_guard lock{*mutex_};
  Where where = where_of(filter);
  if (filter.before_id > 0) where.add("id < ?", filter.before_id);
  const int limit = std::clamp(filter.limit, 1, k_most_scans);
  BITELINE_ASSIGN(Statement rows,
                  database_->prepare(std::string{"SELECT "} + k_scan_columns +
                                     ", (SELECT reason FROM scan_texts WHERE scan = id) FROM scans" +
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
    page.scans.back().reason = rows.text(21);
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
                                       "AND verdict <> 'held' ORDER BY time, id"));
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

Result<Trends> Memory::trends(const ScanFilter& filter) const {
  const std::lock_guard lock{*mutex_};
  Trends trends;
  // Day by day along the index: one GROUP BY over all would sort 100 000 rows first.
  ScanFilter rest = filter;
  rest.from.reset();
  rest.to.reset();
  Where where;
  where.add("time >= ?", std::int64_t{0});
  where.add("time < ?", std::int64_t{0});
  const Where others = where_of(rest);
  const std::string sql = where.sql + (others.sql.empty() ? "" : " AND" + others.sql.substr(6));
  BITELINE_ASSIGN(Statement next, database_->prepare("SELECT min(time) FROM scans" + sql));
  BITELINE_ASSIGN(
      Statement day,
      database_->prepare("SELECT count(*), sum(verdict = 'ok'), sum(verdict = 'refused'), sum(verdict "
                         "= 'failed'), avg(length_mm), avg(confidence), avg(u95_mm), avg(cycle_s) "
                         "FROM scans" +
                         sql));
  const UnixMs end = filter.to.value_or(std::numeric_limits<UnixMs>::max());
  UnixMs from = filter.from.value_or(0);
  while (true) {
    next.again();
    others.bind_to(next.bind(from).bind(end));
    BITELINE_TRY(next.step());
    if (next.is_null(0)) break;
    const std::int64_t number = next.integer(0) / k_day_ms;
    const UnixMs until = std::min(end, (number + 1) * k_day_ms);
    day.again();
    others.bind_to(day.bind(from).bind(until));
    BITELINE_TRY(day.step());
    trends.days.push_back({.day = day_text(number),
                           .scans = day.integer(0),
                           .ok = day.integer(1),
                           .refused = day.integer(2),
                           .failed = day.integer(3),
                           .mean_length_mm = day.number_if(4),
                           .mean_confidence = day.number_if(5),
                           .mean_u95_mm = day.number_if(6),
                           .mean_cycle_s = day.number_if(7)});
    from = until;
  }
  Where refused = where_of(filter);
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

Result<std::vector<LogRow>> Memory::log_rows(std::int64_t before_id, int limit) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement rows,
                  database_->prepare("SELECT id, time, who, door, action, subject, before, after "
                                     "FROM log WHERE id < ? ORDER BY id DESC LIMIT ?"));
  rows.bind(before_id > 0 ? before_id : std::numeric_limits<std::int64_t>::max());
  rows.bind(std::clamp(limit, 1, k_most_scans));
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
        database_->prepare("INSERT INTO users (name, role, password_hash, created) VALUES (?, ?, ?, ?) "
                           "ON CONFLICT (name) DO UPDATE SET role = excluded.role, password_hash = "
                           "excluded.password_hash"));
    BITELINE_TRY(put.bind(user.name).bind(user.role).bind(user.password_hash).bind(user.created).run());
    // Whoever has another role or password logs in again.
    BITELINE_ASSIGN(Statement sessions, database_->prepare("DELETE FROM sessions WHERE user = ?"));
    BITELINE_TRY(sessions.bind(user.name).run());
    return add_log(event);
  });
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
  BITELINE_ASSIGN(Statement rows,
                  database_->prepare("SELECT name, role, password_hash, created FROM users ORDER BY name"));
  std::vector<User> users;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return users;
    users.push_back({.name = rows.text(0),
                     .role = rows.text(1),
                     .password_hash = rows.text(2),
                     .created = rows.integer(3)});
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
