// SPDX-License-Identifier: MIT
#include "host/fleet/recordings.hpp"

#include <algorithm>
#include <array>

#include "host/fleet/centre_state.hpp"
#include "host/fleet/recording_messages.hpp"

namespace biteline::fleet {
namespace {

constexpr std::array k_states{"asked", "coming", "whole", "refused"};

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
          .online = row[10].as<bool>()};
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

Result<std::vector<FetchRow>> Recordings::rows(const std::string& where) {
  return centre_.work<std::vector<FetchRow>>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    std::vector<FetchRow> rows;
    for (const pqxx::row& row :
         work.exec("SELECT f.number, f.cell, f.book, f.scan, f.state, f.have, f.total, f.sha256, f.tries, "
                   "f.words, coalesce(c.online, false) FROM fetches f LEFT JOIN cells c ON c.cell = f.cell " +
                   where))
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
    work.exec_params0(
        "UPDATE fetches SET state = $2, have = $3, total = $4, sha256 = $5, tries = $6, words = $7 WHERE "
        "number = $1 AND state IN ('asked', 'coming')",
        row.number, to_text(row.state), row.have, row.total, row.sha256, row.tries, text_of(row.words));
    work.commit();
    return true;
  });
  if (!noted) return tl::unexpected<Error>{noted.error()};
  return {};
}

}  // namespace biteline::fleet
