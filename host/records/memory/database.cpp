// SPDX-License-Identifier: MIT
#include "host/records/memory/database.hpp"

#include <sqlite3.h>
#include <sys/stat.h>

#include <cerrno>
#include <string>

namespace biteline::memory {
namespace {

/// Another program's short reading (a backup by hand) is waited for.
constexpr int k_busy_ms = 2000;

/// Called at once after the call that failed, before which errno was 0.
tl::unexpected<Error> failure(sqlite3* database, int code, const std::string& what) {
  const int primary = code & 0xff;
  const int sys_errno = errno;
  // A quota and a limit on a file's size are told as faults of the device; SQLite does not say which.
  const bool no_room = sys_errno == ENOSPC || sys_errno == EDQUOT || sys_errno == EFBIG;
  if (primary == SQLITE_FULL || (no_room && (primary == SQLITE_IOERR || primary == SQLITE_CANTOPEN)))
    return fail_errno(Errc::DiskFull, sys_errno, "%.180s", what.c_str());
  const char* const words = database != nullptr ? sqlite3_errmsg(database) : sqlite3_errstr(code);
  Errc errc = Errc::WriteFailed;
  if (primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB) errc = Errc::BadFormat;
  if (primary == SQLITE_CANTOPEN) errc = Errc::FileUnreadable;
  if (primary == SQLITE_CONSTRAINT) errc = Errc::BadValue;
  if (primary == SQLITE_BUSY || primary == SQLITE_LOCKED) errc = Errc::PeerRefused;
  return fail(errc, "%.120s: %.120s", what.c_str(), words);
}

}  // namespace

void Statement::Closer::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

Statement& Statement::bind(std::string_view text) {
  const int code = sqlite3_bind_text64(statement_.get(), ++bound_, text.data() != nullptr ? text.data() : "",
                                       text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  if (code != SQLITE_OK) worst_ = code;
  return *this;
}

Statement& Statement::bind(std::int64_t number) {
  const int code = sqlite3_bind_int64(statement_.get(), ++bound_, number);
  if (code != SQLITE_OK) worst_ = code;
  return *this;
}

Statement& Statement::bind(double number) {
  const int code = sqlite3_bind_double(statement_.get(), ++bound_, number);
  if (code != SQLITE_OK) worst_ = code;
  return *this;
}

Statement& Statement::bind(std::span<const std::uint8_t> bytes) {
  const int code =
      sqlite3_bind_blob64(statement_.get(), ++bound_, bytes.data() != nullptr ? bytes.data() : nullptr,
                          bytes.size(), SQLITE_TRANSIENT);
  if (code != SQLITE_OK) worst_ = code;
  return *this;
}

Statement& Statement::bind_null() {
  const int code = sqlite3_bind_null(statement_.get(), ++bound_);
  if (code != SQLITE_OK) worst_ = code;
  return *this;
}

Result<bool> Statement::step() {
  sqlite3* const database = sqlite3_db_handle(statement_.get());
  if (worst_ != SQLITE_OK) return failure(nullptr, worst_, "memory: a value cannot be bound");
  errno = 0;
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  const char* const file = sqlite3_db_filename(database, "main");
  return failure(database, code, file != nullptr && *file != '\0' ? file : "memory");
}

Result<void> Statement::run() {
  while (true) {
    BITELINE_ASSIGN(const bool row, step());
    if (!row) return {};
  }
}

void Statement::again() {
  sqlite3_reset(statement_.get());
  bound_ = 0;
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

std::string Statement::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  if (text == nullptr) return {};
  return {text, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::number(int column) const {
  return sqlite3_column_double(statement_.get(), column);
}

std::optional<double> Statement::number_if(int column) const {
  if (is_null(column)) return std::nullopt;
  return number(column);
}

std::span<const std::uint8_t> Statement::bytes(int column) const {
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_.get(), column));
  return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

void Database::Closer::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

Result<Database> Database::open(const std::filesystem::path& file, Access access) {
  const int flags =
      access == Access::ReadOnly ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  // Passwords' hashes stand in it.
  const mode_t before = ::umask(0077);
  sqlite3* handle = nullptr;
  errno = 0;
  const int code = sqlite3_open_v2(file.c_str(), &handle, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  Database database{handle, file};
  if (code != SQLITE_OK) {
    ::umask(before);
    return failure(handle, code, file.string());
  }
  sqlite3_busy_timeout(handle, k_busy_ms);
  sqlite3_extended_result_codes(handle, 1);
  const Result<void> set =
      access == Access::ReadOnly
          ? database.execute("PRAGMA query_only = ON")
          : database.execute(
                "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = "
                "ON; PRAGMA trusted_schema = OFF");
  ::umask(before);
  if (!set) return tl::unexpected<Error>{set.error()};
  return database;
}

Result<Statement> Database::prepare(std::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  errno = 0;
  const int code =
      sqlite3_prepare_v2(database_.get(), sql.data(), static_cast<int>(sql.size()), &statement, nullptr);
  if (code != SQLITE_OK) return failure(database_.get(), code, file_.string());
  return Statement{statement};
}

Result<void> Database::execute(const std::string& sql) {
  errno = 0;
  const int code = sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) return failure(database_.get(), code, file_.string());
  return {};
}

Result<void> Database::transaction(const std::function<Result<void>()>& work) {
  BITELINE_TRY(execute("BEGIN IMMEDIATE"));
  Result<void> done = work();
  if (done) done = execute("COMMIT");
  // A full disk may have rolled it back already: then this is the error that does not matter.
  if (!done && sqlite3_get_autocommit(database_.get()) == 0) static_cast<void>(execute("ROLLBACK"));
  return done;
}

std::int64_t Database::changes() const {
  return sqlite3_changes64(database_.get());
}

std::int64_t Database::last_id() const {
  return sqlite3_last_insert_rowid(database_.get());
}

Result<void> Database::copy_to(const std::filesystem::path& target) {
  BITELINE_ASSIGN(Database copy, open(target, Access::ReadWrite));
  sqlite3_backup* backup = sqlite3_backup_init(copy.database_.get(), "main", database_.get(), "main");
  if (backup == nullptr)
    return failure(copy.database_.get(), sqlite3_errcode(copy.database_.get()), target.string());
  errno = 0;
  // All pages in one step: no writer of another process comes between.
  sqlite3_backup_step(backup, -1);
  const int code = sqlite3_backup_finish(backup);
  if (code != SQLITE_OK) return failure(copy.database_.get(), code, target.string());
  return {};
}

}  // namespace biteline::memory
