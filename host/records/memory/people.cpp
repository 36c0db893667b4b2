// SPDX-License-Identifier: MIT
// Users and their sessions.
#include <utility>

#include "host/records/memory/memory.hpp"

namespace biteline::memory {

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

namespace {

Session session_in(Statement& row) {
  return {.token_hash = row.text(0),
          .user = row.text(1),
          .role = row.text(2),
          .created = row.integer(3),
          .expires = row.integer(4)};
}

}  // namespace

Result<std::optional<Session>> Memory::session(const std::string& token_hash) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement row,
                  database_->prepare("SELECT token_hash, user, role, created, expires FROM sessions "
                                     "WHERE token_hash = ?"));
  row.bind(token_hash);
  BITELINE_ASSIGN(const bool found, row.step());
  if (!found) return std::optional<Session>{};
  return std::optional<Session>{session_in(row)};
}

Result<std::vector<Session>> Memory::sessions() const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement rows,
                  database_->prepare("SELECT token_hash, user, role, created, expires FROM sessions"));
  std::vector<Session> sessions;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return sessions;
    sessions.push_back(session_in(rows));
  }
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

}  // namespace biteline::memory
