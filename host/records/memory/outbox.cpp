// SPDX-License-Identifier: MIT
#include "host/records/memory/outbox.hpp"

#include <cstring>
#include <utility>

namespace biteline::memory {

Result<Outbox> Outbox::open(const std::filesystem::path& file) {
  BITELINE_ASSIGN(Memory memory, Memory::open_to_read(file));
  BITELINE_ASSIGN(Database database, Database::open(file, Database::Access::ReadOnly));
  return Outbox{std::move(memory), std::move(database)};
}

Result<std::int64_t> Outbox::number(const char* sql, std::int64_t bound) {
  BITELINE_ASSIGN(Statement statement, database_.prepare(sql));
  statement.bind(bound);
  BITELINE_TRY(statement.step());
  return statement.integer(0);
}

Result<std::string> Outbox::book() {
  BITELINE_ASSIGN(Statement book, database_.prepare("SELECT value FROM settings WHERE key = 'outbox'"));
  BITELINE_ASSIGN(const bool found, book.step());
  if (!found) return fail(Errc::BadFormat, "%.150s: its outbox has no name", database_.file().c_str());
  return book.text(0);
}

Result<OutboxPart> Outbox::after(std::int64_t seq, int limit) {
  OutboxPart part;
  BITELINE_ASSIGN(part.book, book());
  BITELINE_ASSIGN(part.waiting, number("SELECT count(*) FROM outbox WHERE seq > ?", seq));
  BITELINE_ASSIGN(std::int64_t before,
                  number("SELECT coalesce(max(seq), 0) FROM outbox WHERE seq <= ?", seq));
  BITELINE_ASSIGN(
      Statement rows,
      database_.prepare(
          "SELECT seq, name, places FROM outbox JOIN scans ON scans.id = outbox.scan "
          "LEFT JOIN scan_places ON scan_places.scan = scans.id WHERE seq > ? ORDER BY seq LIMIT ?"));
  rows.bind(seq).bind(limit);
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return part;
    OutboxRow one;
    one.seq = rows.integer(0);
    one.after = std::exchange(before, one.seq);
    const std::string name = rows.text(1);
    if (const auto bytes = rows.bytes(2); bytes.size() == sizeof(Places)) {
      one.places.emplace();
      std::memcpy(one.places->data(), bytes.data(), sizeof(Places));
    }
    BITELINE_ASSIGN(std::optional<Scan> scan, memory_.scan(name));
    // A name that finds nothing (a file that was written by hand) holds up no other row.
    if (scan) one.scan = std::move(*scan);
    part.rows.push_back(std::move(one));
  }
}

Result<OutboxPart> Outbox::last() {
  BITELINE_ASSIGN(const std::int64_t newest,
                  number("SELECT coalesce(max(seq), 0) FROM outbox WHERE seq > ?", 0));
  return after(newest - 1, 1);
}

Result<LogLink> Outbox::last_log_link() {
  BITELINE_ASSIGN(
      Statement newest,
      database_.prepare(
          "SELECT id, link FROM log WHERE link IS NOT NULL AND link <> '' ORDER BY id DESC LIMIT 1"));
  BITELINE_ASSIGN(const bool found, newest.step());
  if (!found) return LogLink{};
  return LogLink{.row = newest.integer(0), .link = newest.text(1)};
}

}  // namespace biteline::memory
