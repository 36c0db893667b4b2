// SPDX-License-Identifier: MIT
#include "host/fleet/recordings.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "host/fleet/centre_state.hpp"
#include "host/fleet/recording_messages.hpp"

namespace biteline::fleet {
namespace {

namespace fs = std::filesystem;

constexpr std::array k_states{"asked", "coming", "whole", "refused", "removed"};
constexpr double k_day_s = 86400;

constexpr const char* k_recording_columns =
    "f.number, f.cell, f.book, f.scan, f.state, f.have, f.total, f.sha256, f.tries, f.words, "
    "coalesce(c.online, false), f.marked";

FetchRow row_of(const pqxx::row& row) {
  const auto state = std::ranges::find(k_states, row[4].as<std::string>());
  return {.number = row[0].as<std::int64_t>(),
          .cell = row[1].as<std::string>(),
          .book = row[2].as<std::string>(),
          .scan = row[3].as<std::string>(),
          .state = static_cast<FetchState>(state - k_states.begin()),
          .have = row[5].as<std::int64_t>(),
          .total = row[6].as<std::int64_t>(),
          .sha256 = row[7].as<std::string>(),
          .tries = row[8].as<int>(),
          .words = row[9].as<std::string>(),
          .online = row[10].as<bool>(),
          .marked = row[11].as<bool>()};
}

}  // namespace

const char* to_text(FetchState state) {
  return k_states.at(static_cast<std::size_t>(state));
}

Result<std::int64_t> Recordings::ask(const std::string& cell, const std::string& scan) {
  return centre_.work<std::int64_t>([&](Centre::State& state) -> Result<std::int64_t> {
    pqxx::work work{state.connection};
    const pqxx::result shoe = work.exec_params(
        "SELECT book FROM shoes WHERE cell = $1 AND scan = $2 ORDER BY id DESC LIMIT 1", cell, scan);
    if (shoe.empty())
      return fail(Errc::InvalidArgument, "%.64s/%.64s: the centre knows no such shoe", cell.c_str(),
                  scan.c_str());
    const auto book = shoe[0][0].as<std::string>();
    // It names a folder here, and a cell said it.
    if (!is_book(book) || !is_scan_folder(scan))
      return fail(Errc::InvalidArgument, "%.64s/%.64s: its memory '%.64s' has no name for a folder",
                  cell.c_str(), scan.c_str(), clean_text(book).c_str());
    work.exec_params0(
        "INSERT INTO fetches (cell, book, scan) VALUES ($1, $2, $3) ON CONFLICT (cell, book, scan) WHERE "
        "state IN ('asked', 'coming') DO NOTHING",
        cell, book, scan);
    const auto number = work.exec_params1(
                                "SELECT number FROM fetches WHERE cell = $1 AND book = $2 AND scan = $3 "
                                "ORDER BY number DESC LIMIT 1",
                                cell, book, scan)[0]
                            .as<std::int64_t>();
    work.commit();
    return number;
  });
}

Result<std::vector<FetchRow>> Recordings::rows(const std::string& rest) {
  return centre_.work<std::vector<FetchRow>>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    std::vector<FetchRow> rows;
    for (const pqxx::row& row : work.exec("SELECT " + std::string{k_recording_columns} +
                                          " FROM fetches f LEFT JOIN cells c ON c.cell = f.cell " + rest))
      rows.push_back(row_of(row));
    return rows;
  });
}

Result<FetchRow> Recordings::row(std::int64_t number) {
  BITELINE_ASSIGN(const std::vector<FetchRow> found, rows("WHERE f.number = " + std::to_string(number)));
  if (found.empty())
    return fail(Errc::InvalidArgument, "fetch %lld: there is none", static_cast<long long>(number));
  return found.front();
}

Result<std::vector<FetchRow>> Recordings::list() {
  return rows("ORDER BY f.number DESC LIMIT 200");
}

Result<std::vector<FetchRow>> Recordings::open() {
  return rows(
      "WHERE f.number IN (SELECT min(number) FROM fetches WHERE state IN ('asked', 'coming') GROUP BY cell)");
}

Result<void> Recordings::note(const FetchRow& row) {
  const Result<bool> noted = centre_.work<bool>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    if (row.state == FetchState::Whole) {
      const pqxx::result older = work.exec_params(
          "UPDATE fetches SET state = 'removed', words = 'fetched anew' WHERE (cell, book, scan) IN (SELECT "
          "cell, "
          "book, scan FROM fetches WHERE number = $1 AND state IN ('asked', 'coming')) AND state = 'whole' "
          "RETURNING marked",
          row.number);
      if (!older.empty() && older[0][0].as<bool>())
        work.exec_params0("UPDATE fetches SET marked = true WHERE number = $1", row.number);
    }
    work.exec_params0(
        "UPDATE fetches SET state = $2, have = $3, total = $4, sha256 = $5, tries = $6, words = $7, ended = "
        "CASE "
        "WHEN $2 IN ('whole', 'refused') THEN now() END WHERE number = $1 AND state IN ('asked', 'coming')",
        row.number, to_text(row.state), row.have, row.total, row.sha256, row.tries, text_of(row.words));
    work.commit();
    return true;
  });
  if (!noted) return tl::unexpected<Error>{noted.error()};
  return {};
}

Result<void> Recordings::mark(const std::string& cell, const std::string& scan, bool marked) {
  const Result<bool> done = centre_.work<bool>([&](Centre::State& state) -> Result<bool> {
    pqxx::work work{state.connection};
    const pqxx::result found = work.exec_params(
        "UPDATE fetches SET marked = $3 WHERE number = (SELECT max(number) FROM fetches WHERE cell = $1 AND "
        "scan = "
        "$2 AND state = 'whole') AND state = 'whole' RETURNING number",
        cell, scan, marked);
    if (found.empty())
      return fail(Errc::InvalidArgument, "%.64s/%.64s: no such recording is here; see --fetches",
                  cell.c_str(), scan.c_str());
    work.commit();
    return true;
  });
  if (!done) return tl::unexpected<Error>{done.error()};
  return {};
}

Result<void> Recordings::tidy(const RecordingLimits& limits, const FileOf& file_of) {
  const Result<bool> done = centre_.work<bool>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    const auto note = [&](std::int64_t number, const char* now, const std::string& words) {
      work.exec_params0("UPDATE fetches SET state = $2, words = $3 WHERE number = $1", number, now,
                        text_of(words));
    };
    // Locked to the end: who marks one meanwhile finds it removed, and is told.
    std::vector<KeptRecording> kept;
    std::map<std::int64_t, fs::path> files;
    for (const pqxx::row& row : work.exec("SELECT " + std::string{k_recording_columns} +
                                          ", extract(epoch FROM now() - f.ended)::float8, EXISTS (SELECT 1 "
                                          "FROM fetches n WHERE n.cell = f.cell "
                                          "AND n.book = f.book AND n.scan = f.scan AND n.state IN ('asked', "
                                          "'coming')) FROM fetches f LEFT JOIN "
                                          "cells c ON c.cell = f.cell WHERE f.state = 'whole' ORDER BY "
                                          "f.ended, f.number FOR UPDATE OF f")) {
      const FetchRow one = row_of(row);
      const fs::path file = file_of(one);
      const bool busy = row[13].as<bool>();
      std::error_code error;
      if (fs::status(file, error).type() == fs::file_type::not_found && !busy) {
        // A disk that is not mounted has lost nothing.
        if (fs::is_directory(file.parent_path(), error)) note(one.number, "removed", "its file is gone");
        continue;
      }
      files.emplace(one.number, file);
      kept.push_back({.number = one.number,
                      .bytes = one.total,
                      .age_days = row[12].as<double>() / k_day_s,
                      .marked = one.marked,
                      .busy = busy});
    }
    for (const Going& going : beyond(limits, kept)) {
      const fs::path& file = files.at(going.number);
      std::error_code error;
      fs::remove(file, error);
      if (error) {
        note(going.number, "whole", file.string() + "; it cannot be removed: " + error.message());
      } else {
        note(going.number, "removed",
             going.by == GoesBy::Age ? "it was too old" : "newer ones needed its room");
      }
    }
    work.commit();
    return true;
  });
  if (!done) return tl::unexpected<Error>{done.error()};
  return {};
}

}  // namespace biteline::fleet
