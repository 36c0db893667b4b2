// SPDX-License-Identifier: MIT
#include "host/fleet/centre.hpp"

#include <algorithm>
#include <utility>

#include "common/core/text.hpp"
#include "common/core/text_bounds.hpp"
#include "common/system/file.hpp"
#include "host/fleet/centre_state.hpp"

namespace biteline::fleet {
namespace {

namespace fs = std::filesystem;

/// Two centres that begin at once do not both raise the tables.
constexpr const char* k_lock = "SELECT pg_advisory_xact_lock(7118)";
constexpr std::size_t k_most_migration_bytes = 1024 * 1024;

/// "0001_cells.sql" as 1; 0: no migration.
int number_of(const fs::path& file) {
  const std::string name = file.filename().string();
  if (file.extension() != ".sql" || name.size() < 5 || name[4] != '_') return 0;
  return std::atoi(name.substr(0, 4).c_str());
}

Result<std::vector<fs::path>> migrations_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator at{folder, error}, end; !error && at != end; at.increment(error)) {
    if (number_of(at->path()) > 0) files.push_back(at->path());
  }
  std::ranges::sort(files);
  if (files.empty())
    return fail(Errc::FileNotFound, "%.200s: no migration (0001_NAME.sql) there", folder.c_str());
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (number_of(files[i]) != static_cast<int>(i) + 1)
      return fail(Errc::BadFormat, "%.200s: number %zu expected next", files[i].c_str(), i + 1);
  }
  return files;
}

std::optional<std::string> array_of(const std::optional<memory::Places>& places) {
  if (!places) return std::nullopt;
  std::string text;
  for (const float place : *places) {
    text += text.empty() ? '{' : ',';
    text += std::to_string(place);
  }
  text += '}';
  return text;
}

constexpr const char* k_put_shoe = R"sql(
INSERT INTO shoes (cell, book, scan, first_seq, last_seq, time, model, verdict, reason_code, reason, length_mm,
  confidence, u95_mm, cycle_s, process, decision, sent, followed, places, release, stub,
  part, foot, size, follows, work, work_reworked, work_missing_mm, work_narrow, work_wide, work_beside,
  work_doubled)
VALUES ($1, $2, $3, $4, $4, to_timestamp($5::bigint / 1000.0), $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17,
  $18::real[], $19, $20, $21, $22, $23, $24, $25, $26, $27, $28, $29, $30, $31)
ON CONFLICT (cell, book, scan) DO UPDATE SET last_seq = excluded.last_seq, time = excluded.time,
  model = excluded.model, verdict = excluded.verdict, reason_code = excluded.reason_code, reason = excluded.reason,
  length_mm = excluded.length_mm, confidence = excluded.confidence, u95_mm = excluded.u95_mm,
  cycle_s = excluded.cycle_s, process = excluded.process, decision = excluded.decision, sent = excluded.sent,
  followed = excluded.followed, places = excluded.places, release = excluded.release, stub = excluded.stub,
  part = excluded.part, foot = excluded.foot, size = excluded.size, follows = excluded.follows,
  work = excluded.work, work_reworked = excluded.work_reworked, work_missing_mm = excluded.work_missing_mm,
  work_narrow = excluded.work_narrow, work_wide = excluded.work_wide, work_beside = excluded.work_beside,
  work_doubled = excluded.work_doubled
)sql";
/// Their reasons, for so many of a cell; the rows themselves stay.
constexpr int k_most_dead_letters = 1000;
constexpr int k_most_books_a_day = 24;

int books_of_a_day(pqxx::work& work, const std::string& cell) {
  return work
      .exec_params1("SELECT count(*) FROM books WHERE cell = $1 AND begun > now() - interval '1 day'",
                    cell)[0]
      .as<int>();
}

/// Where a cell's book stands; the row is locked to the transaction's end.  Nothing: the cell has begun too
/// many books.
std::optional<std::int64_t> position(pqxx::work& work, const std::string& cell, const std::string& book) {
  constexpr const char* k_look = "SELECT seq FROM books WHERE cell = $1 AND book = $2 FOR UPDATE";
  if (const pqxx::result known = work.exec_params(k_look, cell, book); !known.empty())
    return known[0][0].as<std::int64_t>();
  if (books_of_a_day(work, cell) >= k_most_books_a_day) return std::nullopt;
  work.exec_params("INSERT INTO books (cell, book, seq) VALUES ($1, $2, 0) ON CONFLICT DO NOTHING", cell,
                   book);
  return work.exec_params1(k_look, cell, book)[0].as<std::int64_t>();
}

void put_dead_letter(pqxx::transaction_base& work, const FromCell& one) {
  work.exec_params0(
      "INSERT INTO dead_letters (cell, book, seq, scan, why) VALUES ($1, $2, $3, $4, $5) "
      "ON CONFLICT (cell, book, seq) DO UPDATE SET why = excluded.why",
      one.cell, one.shoe.book, one.shoe.seq, text_of(one.shoe.scan.name), text_of(one.shoe.fault));
  work.exec_params0(
      "DELETE FROM dead_letters WHERE cell = $1 AND id <= (SELECT id FROM dead_letters WHERE cell = $1 "
      "ORDER BY id DESC OFFSET $2 LIMIT 1)",
      one.cell, k_most_dead_letters);
}

void put(pqxx::transaction_base& work, const FromCell& one) {
  const ShoeMessage& shoe = one.shoe;
  const memory::Scan& scan = shoe.scan;
  work.exec_params(k_put_shoe, one.cell, shoe.book, text_of(scan.name), shoe.seq, scan.time,
                   text_of(scan.model), text_of(scan.verdict), text_of(scan.reason_code),
                   text_of(scan.reason), scan.length_mm, scan.confidence, scan.u95_mm, scan.cycle_s,
                   text_of(scan.process), text_of(scan.decision), scan.sent, scan.followed.value_or(false),
                   array_of(shoe.places), text_of(shoe.release), !shoe.fault.empty(), text_of(scan.part),
                   text_of(scan.foot), text_of(scan.size), text_of(scan.follows), text_of(scan.work.verdict),
                   scan.work.reworked, scan.work.missing_mm, scan.work.narrow, scan.work.wide,
                   scan.work.beside, scan.work.doubled);
  if (!shoe.fault.empty()) put_dead_letter(work, one);
}

/// A row that the database itself refuses is put without its content: neither its cell's nor any other's line
/// stands still for it.
void put_whatever_it_is(pqxx::work& work, const FromCell& one) {
  std::string why;
  try {
    pqxx::subtransaction part{work};
    put(part, one);
    part.commit();
    return;
  } catch (const pqxx::broken_connection&) {
    throw;
  } catch (const pqxx::sql_error& error) {
    why = "the database refuses it: " + clean_text(error.what(), bounds::k_word);
  }
  put(work, {.cell = one.cell, .shoe = bare_of(one.shoe, why)});
}

/// What a cell is told of its book.
CommittedMessage word_of(pqxx::work& work, const std::string& cell, const std::string& book,
                         std::int64_t seq) {
  CommittedMessage word{.book = book, .seq = seq};
  word.dead =
      work.exec_params1("SELECT count(*) FROM dead_letters WHERE cell = $1 AND book = $2", cell, book)[0]
          .as<std::int64_t>();
  if (word.dead == 0) return word;
  for (const pqxx::row& row : work.exec_params(
           "SELECT seq, scan, why FROM (SELECT * FROM dead_letters WHERE cell = $1 AND book = $2 "
           "ORDER BY seq DESC LIMIT $3) AS newest ORDER BY seq",
           cell, book, static_cast<int>(k_most_letters_told)))
    word.letters.push_back({.seq = row[0].as<std::int64_t>(),
                            .scan = row[1].as<std::string>(),
                            .why = row[2].as<std::string>()});
  return word;
}

CommittedMessage too_many_books(const std::string& book) {
  return {.book = book,
          .seq = 0,
          .held = "more than " + std::to_string(k_most_books_a_day) +
                  " new memories of this cell in a day: its shoes are taken tomorrow"};
}

template <class Put>
std::vector<CommittedOf> commit_all(pqxx::connection& connection, const std::vector<FromCell>& shoes,
                                    const Put& put_one) {
  // Locks are taken in one order, so that two centres cannot wait for each other.
  std::vector<std::pair<std::string, std::string>> books;
  for (const FromCell& one : shoes) books.emplace_back(one.cell, one.shoe.book);
  std::ranges::sort(books);
  books.erase(std::ranges::unique(books).begin(), books.end());
  pqxx::work work{connection};
  std::vector<CommittedOf> committed;
  for (const auto& [cell, book] : books) {
    const std::optional<std::int64_t> stands = position(work, cell, book);
    if (!stands) {
      committed.push_back({.cell = cell, .to = too_many_books(book)});
      continue;
    }
    std::int64_t seq = *stands;
    for (const FromCell& one : shoes) {
      if (one.cell != cell || one.shoe.book != book || one.shoe.after != seq) continue;
      put_one(work, one);
      seq = one.shoe.seq;
    }
    work.exec_params0("UPDATE books SET seq = $3 WHERE cell = $1 AND book = $2", cell, book, seq);
    committed.push_back({.cell = cell, .to = word_of(work, cell, book, seq)});
  }
  work.commit();
  return committed;
}

}  // namespace

Centre::Centre(std::unique_ptr<State> state) : state_{std::move(state)} {}
Centre::Centre(Centre&&) noexcept = default;
Centre& Centre::operator=(Centre&&) noexcept = default;
Centre::~Centre() = default;

Result<Centre> Centre::open(const std::string& database, const fs::path& migrations) {
  BITELINE_ASSIGN(const std::vector<fs::path> files, migrations_in(migrations));
  std::vector<std::string> texts;
  for (const fs::path& file : files) {
    BITELINE_ASSIGN(texts.emplace_back(), read_regular_file(file, k_most_migration_bytes));
  }
  try {
    Centre centre{std::make_unique<State>(database)};
    pqxx::work work{centre.state_->connection};
    work.exec(k_lock);
    work.exec0(
        "CREATE TABLE IF NOT EXISTS migrations (number integer PRIMARY KEY, name text NOT NULL, "
        "done timestamptz NOT NULL DEFAULT now())");
    const auto done = work.exec1("SELECT coalesce(max(number), 0) FROM migrations")[0].as<int>();
    if (done > static_cast<int>(files.size()))
      return fail(Errc::NotSupported,
                  "database: its tables are of migration %d, this program knows %zu; update it", done,
                  files.size());
    for (std::size_t i = static_cast<std::size_t>(done); i < files.size(); ++i) {
      work.exec(texts[i]);
      work.exec_params0("INSERT INTO migrations (number, name) VALUES ($1, $2)", static_cast<int>(i) + 1,
                        files[i].filename().string());
    }
    work.commit();
    return centre;
  } catch (const pqxx::broken_connection& error) {
    return fail(Errc::ConnectFailed, "database: %.200s", clean_text(error.what()).c_str());
  } catch (const std::exception& error) {
    return fail(Errc::DeviceError, "database: %.200s", clean_text(error.what()).c_str());
  }
}

Result<std::vector<CommittedOf>> Centre::commit(const std::vector<FromCell>& shoes) {
  return work<std::vector<CommittedOf>>([&](State& state) {
    try {
      return commit_all(state.connection, shoes, put);
    } catch (const pqxx::broken_connection&) {
      throw;
    } catch (const pqxx::sql_error&) {
      // One of them cannot be put: once more, each by itself.
      return commit_all(state.connection, shoes, put_whatever_it_is);
    }
  });
}

Result<CommittedMessage> Centre::committed(const std::string& cell, const std::string& book) {
  return work<CommittedMessage>([&](State& state) {
    pqxx::work work{state.connection};
    const pqxx::result rows =
        work.exec_params("SELECT seq FROM books WHERE cell = $1 AND book = $2", cell, book);
    if (rows.empty() && books_of_a_day(work, cell) >= k_most_books_a_day) return too_many_books(book);
    return word_of(work, cell, book, rows.empty() ? 0 : rows[0][0].as<std::int64_t>());
  });
}

Result<void> Centre::note_health(const std::string& cell, const HealthMessage& health) {
  const Result<bool> noted = work<bool>([&](State& state) {
    pqxx::work work{state.connection};
    // A will knows neither version nor book: what was known stays.
    work.exec_params0(
        "INSERT INTO cells (cell, online, heard, version, book, waiting) VALUES ($1, $2, now(), $3, $4, $5) "
        "ON CONFLICT (cell) DO UPDATE SET online = $2, heard = CASE WHEN $2 THEN now() ELSE cells.heard END, "
        "version = CASE WHEN $2 THEN $3 ELSE cells.version END, "
        "book = CASE WHEN $2 THEN $4 ELSE cells.book END, "
        "waiting = CASE WHEN $2 THEN $5 ELSE cells.waiting END",
        cell, health.online, text_of(health.version), text_of(health.book), health.waiting);
    // An index finds it where it was told before, every few seconds.
    if (health.log.row > 0)
      work.exec_params0(
          "INSERT INTO log_links (cell, book, log_row, link) SELECT $1, $2, $3, $4 WHERE NOT EXISTS (SELECT "
          "1 "
          "FROM log_links WHERE cell = $1 AND book = $2 AND log_row = $3 AND link = $4)",
          cell, text_of(health.book), health.log.row, text_of(health.log.link));
    work.commit();
    return true;
  });
  if (!noted) return tl::unexpected<Error>{noted.error()};
  return {};
}

Result<std::vector<CellRow>> Centre::cells() {
  return work<std::vector<CellRow>>([&](State& state) {
    pqxx::work work{state.connection};
    std::vector<CellRow> rows;
    for (const pqxx::row& row : work.exec(
             "SELECT cells.cell, version, online, (extract(epoch FROM heard) * 1000)::bigint, waiting, "
             "count(scan), count(*) FILTER (WHERE verdict = 'ok'), count(*) FILTER (WHERE verdict = "
             "'amber'), "
             "count(*) FILTER (WHERE verdict = 'refused'), "
             "count(*) FILTER (WHERE verdict NOT IN ('ok', 'amber', 'review', 'refused')), "
             "(extract(epoch FROM max(time)) * 1000)::bigint, count(*) FILTER (WHERE verdict = 'review') "
             "FROM cells LEFT JOIN shoes ON shoes.cell = cells.cell AND follows = '' GROUP BY cells.cell "
             "ORDER BY "
             "cells.cell")) {
      CellRow cell;
      cell.cell = row[0].as<std::string>();
      cell.version = row[1].as<std::string>();
      cell.online = row[2].as<bool>();
      cell.heard_ms = row[3].as<std::int64_t>();
      cell.waiting = row[4].as<std::int64_t>();
      cell.shoes = row[5].as<std::int64_t>();
      cell.ok = row[6].as<std::int64_t>();
      cell.amber = row[7].as<std::int64_t>();
      cell.refused = row[8].as<std::int64_t>();
      cell.failed = row[9].as<std::int64_t>();
      if (!row[10].is_null()) cell.last_shoe_ms = row[10].as<std::int64_t>();
      cell.review = row[11].as<std::int64_t>();
      rows.push_back(std::move(cell));
    }
    return rows;
  });
}

Result<std::vector<ToldLink>> Centre::log_links(const std::string& cell) {
  return work<std::vector<ToldLink>>([&](State& state) {
    pqxx::work work{state.connection};
    std::vector<ToldLink> links;
    for (const pqxx::row& row : work.exec_params(
             "SELECT log_row, link, book, (extract(epoch FROM told) * 1000)::bigint FROM (SELECT * FROM "
             "log_links WHERE cell = $1 ORDER BY id DESC LIMIT 50000) AS newest ORDER BY id",
             text_of(cell)))
      links.push_back({.link = {.row = row[0].as<std::int64_t>(), .link = row[1].as<std::string>()},
                       .book = row[2].as<std::string>(),
                       .told_ms = row[3].as<std::int64_t>()});
    return links;
  });
}

Result<std::vector<std::string>> Centre::models() {
  return work<std::vector<std::string>>([&](State& state) {
    pqxx::work work{state.connection};
    std::vector<std::string> models;
    for (const pqxx::row& row : work.exec(
             "SELECT DISTINCT model FROM shoes WHERE places IS NOT NULL AND model <> '' ORDER BY model"))
      models.push_back(row[0].as<std::string>());
    return models;
  });
}

Result<std::vector<PlacedShoe>> Centre::placed_shoes(const std::string& model, int most) {
  return work<std::vector<PlacedShoe>>([&](State& state) {
    pqxx::work work{state.connection};
    std::vector<PlacedShoe> shoes;
    for (const pqxx::row& row : work.exec_params("SELECT cell, scan, places FROM (SELECT id, cell, scan, "
                                                 "places, row_number() OVER (PARTITION BY cell "
                                                 "ORDER BY id DESC) AS age FROM shoes WHERE model = $1 AND "
                                                 "array_length(places, 1) = $3) AS newest "
                                                 "WHERE age <= $2 ORDER BY id",
                                                 model, most, static_cast<int>(memory::k_places))) {
      PlacedShoe shoe{.cell = row[0].as<std::string>(), .scan = row[1].as<std::string>(), .places = {}};
      pqxx::array_parser parser{row[2].c_str()};
      std::size_t at = 0;
      for (auto next = parser.get_next(); next.first != pqxx::array_parser::done; next = parser.get_next()) {
        if (next.first == pqxx::array_parser::string_value && at < shoe.places.size())
          shoe.places.at(at++) = std::stof(next.second);
      }
      if (at == shoe.places.size()) shoes.push_back(std::move(shoe));
    }
    return shoes;
  });
}

}  // namespace biteline::fleet
