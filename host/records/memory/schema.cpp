// SPDX-License-Identifier: MIT
#include "host/records/memory/schema.hpp"

#include <array>

namespace biteline::memory {
namespace {

// Steps are added at the end and never changed: files of every released version are in the field.
// Long texts stand beside the scans' rows, so that lists and trends read little.
constexpr std::array k_steps{
    R"sql(
CREATE TABLE scans (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,
  time INTEGER NOT NULL,
  model TEXT NOT NULL,
  model_probability REAL,
  verdict TEXT NOT NULL,
  reason_code TEXT NOT NULL,
  length_mm REAL,
  confidence REAL,
  u95_mm REAL,
  weak_stretches INTEGER NOT NULL,
  scan_s REAL,
  line_s REAL,
  cycle_s REAL,
  operator TEXT NOT NULL,
  process TEXT NOT NULL,
  decision TEXT NOT NULL,
  decided_by TEXT NOT NULL,
  decided_at INTEGER,
  sent INTEGER NOT NULL,
  followed INTEGER,
  line_version INTEGER NOT NULL,
  marked INTEGER NOT NULL DEFAULT 0,
  folder_gone INTEGER NOT NULL DEFAULT 0
) STRICT;
CREATE INDEX scans_time ON scans (time, verdict, length_mm, u95_mm, cycle_s);
CREATE INDEX scans_model ON scans (model, id);
CREATE INDEX scans_model_time ON scans (model, time, verdict, length_mm, u95_mm, cycle_s);
CREATE INDEX scans_verdict ON scans (verdict, id);
CREATE INDEX scans_reason ON scans (reason_code, time);
CREATE TABLE scan_texts (
  scan INTEGER PRIMARY KEY REFERENCES scans (id) ON DELETE CASCADE,
  reason TEXT NOT NULL,
  next_step TEXT NOT NULL,
  why TEXT NOT NULL,
  versions TEXT NOT NULL,
  details TEXT NOT NULL
) STRICT;
CREATE TABLE scan_places (
  scan INTEGER PRIMARY KEY REFERENCES scans (id) ON DELETE CASCADE,
  model TEXT NOT NULL,
  time INTEGER NOT NULL,
  places BLOB NOT NULL
) STRICT;
CREATE INDEX scan_places_model ON scan_places (model, time);
CREATE TABLE log (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  time INTEGER NOT NULL,
  who TEXT NOT NULL,
  door TEXT NOT NULL,
  action TEXT NOT NULL,
  subject TEXT NOT NULL,
  before TEXT NOT NULL,
  after TEXT NOT NULL
) STRICT;
CREATE INDEX log_time ON log (time);
CREATE TRIGGER log_is_not_changed BEFORE UPDATE ON log BEGIN SELECT RAISE(ABORT, 'the log is append-only'); END;
CREATE TRIGGER log_is_not_deleted BEFORE DELETE ON log BEGIN SELECT RAISE(ABORT, 'the log is append-only'); END;
CREATE TABLE users (
  name TEXT PRIMARY KEY,
  role TEXT NOT NULL CHECK (role IN ('viewer', 'operator', 'engineer', 'administrator')),
  password_hash TEXT NOT NULL,
  created INTEGER NOT NULL,
  enabled INTEGER NOT NULL,
  last_login INTEGER
) STRICT;
CREATE TABLE sessions (
  token_hash TEXT PRIMARY KEY,
  user TEXT NOT NULL,
  role TEXT NOT NULL,
  created INTEGER NOT NULL,
  expires INTEGER NOT NULL
) STRICT;
CREATE TABLE settings (key TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT;
)sql",
    // What the centre is to be told, in order.  A number never comes twice; the book's name tells this file
    // from another.
    R"sql(
CREATE TABLE outbox (
  seq INTEGER PRIMARY KEY AUTOINCREMENT,
  scan INTEGER NOT NULL REFERENCES scans (id) ON DELETE CASCADE
) STRICT;
INSERT INTO outbox (scan) SELECT id FROM scans ORDER BY id;
INSERT INTO settings (key, value) VALUES ('outbox', lower(hex(randomblob(8))));
)sql",
    // Trends leave out what a person stopped: the index that they are read from knows the reason, too.
    R"sql(
DROP INDEX scans_time;
DROP INDEX scans_model_time;
CREATE INDEX scans_time ON scans (time, verdict, reason_code, length_mm, u95_mm, cycle_s);
CREATE INDEX scans_model_time ON scans (model, time, verdict, reason_code, length_mm, u95_mm, cycle_s);
)sql",
    // What was looked at is what is sent.
    R"sql(
CREATE TABLE scan_evidence (
  scan INTEGER PRIMARY KEY REFERENCES scans (id) ON DELETE CASCADE,
  line TEXT NOT NULL,
  cloud TEXT NOT NULL,
  process TEXT NOT NULL,
  report TEXT NOT NULL
) STRICT;
)sql",
    // Whose shoe it was: found by its part number, and told when it comes a second time.
    R"sql(
ALTER TABLE scans ADD COLUMN part TEXT NOT NULL DEFAULT '';
ALTER TABLE scans ADD COLUMN foot TEXT NOT NULL DEFAULT '';
ALTER TABLE scans ADD COLUMN size TEXT NOT NULL DEFAULT '';
CREATE INDEX scans_part ON scans (part, id) WHERE part <> '';
)sql",
    // Who teaches what: facts alone, the steps follow of them.
    R"sql(
CREATE TABLE teachings (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  begun INTEGER NOT NULL,
  begun_by TEXT NOT NULL,
  line_version INTEGER NOT NULL,
  process TEXT NOT NULL,
  process_sha256 TEXT NOT NULL,
  process_by TEXT NOT NULL,
  verdict TEXT NOT NULL,
  has_path INTEGER NOT NULL,
  model TEXT NOT NULL,
  ended INTEGER,
  ended_by TEXT NOT NULL,
  ended_how TEXT NOT NULL CHECK (ended_how IN ('', 'saved', 'given_up', 'replaced'))
) STRICT;
CREATE TABLE teaching_scans (
  teaching INTEGER NOT NULL REFERENCES teachings (id) ON DELETE CASCADE,
  place INTEGER NOT NULL,
  scan TEXT NOT NULL,
  PRIMARY KEY (teaching, place)
) STRICT;
CREATE INDEX teaching_scans_scan ON teaching_scans (scan, teaching);
CREATE TABLE teaching_deeds (
  teaching INTEGER NOT NULL REFERENCES teachings (id) ON DELETE CASCADE,
  deed TEXT NOT NULL CHECK (deed IN ('dry_run', 'air', 'followed')),
  scan TEXT NOT NULL,
  line_version INTEGER NOT NULL,
  process_sha256 TEXT NOT NULL,
  who TEXT NOT NULL,
  time INTEGER NOT NULL,
  outcome TEXT NOT NULL,
  mark TEXT NOT NULL,
  PRIMARY KEY (teaching, deed)
) STRICT;
CREATE INDEX scans_held ON scans (id) WHERE decision = 'held';
)sql",
    // How far the tool's tip may have been off the line.
    R"sql(
ALTER TABLE scans ADD COLUMN tip_bound_mm REAL;
)sql",
    // What a look after the work told.
    R"sql(
ALTER TABLE scans ADD COLUMN work TEXT NOT NULL DEFAULT '';
ALTER TABLE scans ADD COLUMN work_reworked INTEGER NOT NULL DEFAULT 0;
ALTER TABLE scans ADD COLUMN work_missing_mm REAL;
ALTER TABLE scans ADD COLUMN work_narrow INTEGER NOT NULL DEFAULT 0;
ALTER TABLE scans ADD COLUMN work_wide INTEGER NOT NULL DEFAULT 0;
ALTER TABLE scans ADD COLUMN work_beside INTEGER NOT NULL DEFAULT 0;
ALTER TABLE scans ADD COLUMN work_doubled INTEGER NOT NULL DEFAULT 0;
)sql",
    // The log as a hash chain; rows of before have no link, the first one that has seals them.
    R"sql(
ALTER TABLE log ADD COLUMN link TEXT NOT NULL DEFAULT '';
)sql",
    // Several results for one shoe; trends count shoes, in the order of an index that has all of it.
    R"sql(
ALTER TABLE scans ADD COLUMN follows TEXT NOT NULL DEFAULT '';
DROP INDEX scans_time;
DROP INDEX scans_model_time;
CREATE INDEX scans_time ON scans (time, verdict, reason_code, follows, length_mm, u95_mm, cycle_s);
CREATE INDEX scans_model_time ON scans (model, time, verdict, reason_code, follows, length_mm, u95_mm, cycle_s);
)sql",
};

Result<int> version_of(Database& database) {
  BITELINE_ASSIGN(Statement statement, database.prepare("PRAGMA user_version"));
  BITELINE_TRY(statement.step());
  return static_cast<int>(statement.integer(0));
}

}  // namespace

int schema_version() {
  return static_cast<int>(k_steps.size());
}

Result<void> check_schema(Database& database) {
  BITELINE_ASSIGN(const int version, version_of(database));
  if (version == schema_version()) return {};
  if (version > schema_version()) {
    return fail(Errc::NotSupported, "%.150s: schema %d of a newer program, this one knows %d; update it",
                database.file().c_str(), version, schema_version());
  }
  return fail(Errc::NotSupported, "%.150s: schema %d, expected %d; start biteline-host once to raise it",
              database.file().c_str(), version, schema_version());
}

Result<void> raise_schema(Database& database) {
  BITELINE_ASSIGN(const int version, version_of(database));
  if (version > schema_version()) return check_schema(database);
  for (int step = version; step < schema_version(); ++step) {
    BITELINE_TRY(database.transaction([&]() -> Result<void> {
      BITELINE_TRY(database.execute(k_steps.at(static_cast<std::size_t>(step))));
      return database.execute("PRAGMA user_version = " + std::to_string(step + 1));
    }));
  }
  return {};
}

}  // namespace biteline::memory
