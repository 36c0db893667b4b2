// SPDX-License-Identifier: MIT
#include "host/records/memory/memory.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "host/records/memory/schema.hpp"

namespace biteline::memory {

namespace fs = std::filesystem;

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

Result<std::vector<LogRow>> Memory::log_rows(std::int64_t before_id, int limit, std::optional<UnixMs> from,
                                             std::optional<UnixMs> to) const {
  const std::lock_guard lock{*mutex_};
  constexpr std::int64_t k_ever = std::numeric_limits<std::int64_t>::max();
  BITELINE_ASSIGN(
      Statement rows,
      database_->prepare(
          "SELECT id, time, who, door, action, subject, before, after FROM log WHERE (time, id) < "
          "(coalesce((SELECT time FROM log WHERE id = ?1), ?2), coalesce(nullif(?1, 0), ?2)) "
          "AND time >= ?3 AND time < ?4 ORDER BY time DESC, id DESC LIMIT ?5"));
  rows.bind(before_id).bind(k_ever).bind(from.value_or(0)).bind(to.value_or(k_ever));
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
