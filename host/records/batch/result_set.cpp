// SPDX-License-Identifier: MIT
#include "host/records/batch/result_set.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <span>
#include <utility>

#include "common/core/numbers.hpp"
#include "host/records/batch/json_fields.hpp"
#include "host/report/json_text.hpp"

namespace biteline::batch {
namespace {

namespace fs = std::filesystem;
using memory::Database;
using memory::Statement;
using nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "lines are stored as this machine holds them");
static_assert(sizeof(LinePlace) == 16);

constexpr int k_schema = 1;
constexpr std::size_t k_most_pinned_points = 100;

/// The columns behind name, kind, hash, verdict, reason_code, reason, line_hash.
std::string figure_columns(const char* after_each) {
  std::string columns;
  for (const FigureRow& row : figure_table()) columns += std::string{", "} + row.name + after_each;
  return columns;
}

std::string schema() {
  return "CREATE TABLE run (build TEXT NOT NULL, settings TEXT NOT NULL) STRICT;"
         "CREATE TABLE recordings (name TEXT PRIMARY KEY, kind TEXT NOT NULL, hash TEXT NOT NULL, "
         "verdict TEXT NOT NULL, reason_code TEXT NOT NULL, reason TEXT NOT NULL, line_hash TEXT NOT NULL, "
         "wall_s REAL, cpu_s REAL, peak_memory_mb REAL" +
         figure_columns(" REAL") +
         ") STRICT;"
         "CREATE TABLE lines (name TEXT PRIMARY KEY REFERENCES recordings (name), places BLOB NOT NULL) "
         "STRICT;"
         "PRAGMA user_version = " +
         std::to_string(k_schema);
}

Result<RunName> read_run(Database& database) {
  BITELINE_ASSIGN(Statement version, database.prepare("PRAGMA user_version"));
  BITELINE_TRY(version.step());
  if (version.integer(0) != k_schema) {
    return fail(Errc::NotSupported, "%.150s: schema %lld, expected %d", database.file().c_str(),
                static_cast<long long>(version.integer(0)), k_schema);
  }
  BITELINE_ASSIGN(Statement run, database.prepare("SELECT build, settings FROM run"));
  BITELINE_ASSIGN(const bool found, run.step());
  if (!found) return fail(Errc::BadFormat, "%s: no run in it", database.file().c_str());
  return RunName{.build = run.text(0), .settings = run.text(1)};
}

Result<std::vector<LinePlace>> places_from(const ordered_json& json, const fs::path& file) {
  std::vector<LinePlace> places;
  if (!json.is_array()) return fail(Errc::BadFormat, "%.180s key line: a list expected", file.c_str());
  for (const ordered_json& row : json) {
    std::array<float, 4> values{};
    if (!row.is_array() || row.size() != values.size())
      return fail(Errc::BadFormat, "%.180s key line: rows of 4 numbers expected", file.c_str());
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!row[i].is_number() || !k_plausible_mm.holds(row[i].get<double>()))
        return fail(Errc::BadValue, "%.180s key line: a number of mm expected", file.c_str());
      values.at(i) = row[i].get<float>();
    }
    places.push_back({values[0], values[1], values[2], values[3]});
  }
  return places;
}

double to_microns(float mm) {
  return std::round(1e3 * static_cast<double>(mm)) / 1e3;
}

}  // namespace

Result<ResultSet> read_baseline(const fs::path& file) {
  BITELINE_ASSIGN(const ordered_json json, read_json_object(file));
  const JsonFields fields{json, file};
  ResultSet set;
  BITELINE_ASSIGN(set.run_.build, fields.text("build"));
  BITELINE_ASSIGN(set.run_.settings, fields.text("settings"));
  BITELINE_ASSIGN(const ordered_json* const rows, fields.array("recordings"));
  for (const ordered_json& json_row : *rows) {
    const JsonFields row_fields{json_row, file};
    ResultRow row;
    BITELINE_ASSIGN(row.name, row_fields.text("name"));
    BITELINE_ASSIGN(row.kind, row_fields.text("kind"));
    BITELINE_ASSIGN(row.hash, row_fields.text("hash"));
    BITELINE_ASSIGN(row.outcome, outcome_of(json_row, file));
    set.rows_.push_back(std::move(row));
    BITELINE_ASSIGN(std::vector<LinePlace> line,
                    places_from(json_row.value("line", ordered_json::array()), file));
    set.lines_.push_back(std::move(line));
  }
  if (!std::ranges::is_sorted(set.rows_, {}, &ResultRow::name))
    return fail(Errc::BadValue, "%s key recordings: sorted by name expected", file.c_str());
  return set;
}

Result<ResultSet> read_results(const fs::path& file) {
  ResultSet set;
  BITELINE_ASSIGN(Database database, Database::open(file, Database::Access::ReadOnly));
  set.database_ = std::make_unique<Database>(std::move(database));
  BITELINE_ASSIGN(set.run_, read_run(*set.database_));
  BITELINE_ASSIGN(Statement row,
                  set.database_->prepare("SELECT name, kind, hash, verdict, reason_code, reason, line_hash, "
                                         "wall_s, cpu_s, peak_memory_mb" +
                                         figure_columns("") + " FROM recordings ORDER BY name"));
  while (true) {
    BITELINE_ASSIGN(const bool more, row.step());
    if (!more) return set;
    ResultRow result{
        .name = row.text(0), .kind = row.text(1), .hash = row.text(2), .outcome = {}, .cost = {}};
    result.outcome.verdict = row.text(3);
    result.outcome.reason_code = row.text(4);
    result.outcome.reason = row.text(5);
    result.outcome.line_hash = row.text(6);
    if (!row.is_null(7))
      result.cost = {.wall_s = row.number(7), .cpu_s = row.number(8), .peak_memory_mb = row.number(9)};
    int column = 10;
    for (const FigureRow& figure : figure_table()) result.outcome.*figure.member = row.number_if(column++);
    set.rows_.push_back(std::move(result));
  }
}

Result<ResultSet> ResultSet::open(const fs::path& place) {
  std::error_code ignored;
  if (place.extension() == ".json") return read_baseline(place);
  const fs::path file = fs::is_directory(place, ignored) ? place / k_result_file : place;
  if (!fs::exists(file, ignored))
    return fail(Errc::FileNotFound, "%s (made by biteline batch merge)", file.c_str());
  return read_results(file);
}

Result<std::vector<LinePlace>> ResultSet::line(std::size_t row) const {
  if (!database_) return lines_.at(row);
  BITELINE_ASSIGN(Statement statement, database_->prepare("SELECT places FROM lines WHERE name = ?"));
  statement.bind(rows_.at(row).name);
  BITELINE_ASSIGN(const bool found, statement.step());
  if (!found) return std::vector<LinePlace>{};
  const std::span<const std::uint8_t> bytes = statement.bytes(0);
  std::vector<LinePlace> places(bytes.size() / sizeof(LinePlace));
  std::memcpy(places.data(), bytes.data(), places.size() * sizeof(LinePlace));
  return places;
}

ResultWriter::ResultWriter(Database database, fs::path file)
    : database_{std::make_unique<Database>(std::move(database))}, file_{std::move(file)} {}

Result<ResultWriter> ResultWriter::create(const fs::path& file, const RunName& run) {
  const fs::path beside = file.string() + "." + std::to_string(::getpid());
  std::error_code ignored;
  fs::remove(beside, ignored);
  BITELINE_ASSIGN(Database database, Database::open(beside, Database::Access::ReadWrite));
  // One file that can be copied, and read where nothing can be written.
  BITELINE_TRY(database.execute("PRAGMA journal_mode = DELETE; PRAGMA synchronous = OFF"));
  BITELINE_TRY(database.execute(schema()));
  BITELINE_TRY(database.execute("BEGIN"));
  BITELINE_ASSIGN(Statement insert, database.prepare("INSERT INTO run VALUES (?, ?)"));
  BITELINE_TRY(insert.bind(run.build).bind(run.settings).run());
  return ResultWriter{std::move(database), file};
}

Result<void> ResultWriter::add(const ResultRow& row, const std::vector<LinePlace>& line) {
  std::string places = "?,?,?,?,?,?,?,?,?,?";
  for (std::size_t i = 0; i < figure_table().size(); ++i) places += ",?";
  BITELINE_ASSIGN(Statement insert, database_->prepare("INSERT INTO recordings VALUES (" + places + ")"));
  insert.bind(row.name).bind(row.kind).bind(row.hash).bind(row.outcome.verdict).bind(row.outcome.reason_code);
  insert.bind(row.outcome.reason).bind(row.outcome.line_hash);
  if (row.cost) {
    insert.bind(row.cost->wall_s).bind(row.cost->cpu_s).bind(row.cost->peak_memory_mb);
  } else {
    insert.bind_null().bind_null().bind_null();
  }
  for (const FigureRow& figure : figure_table()) insert.bind(row.outcome.*figure.member);
  BITELINE_TRY(insert.run());
  if (line.empty()) return {};
  BITELINE_ASSIGN(Statement put, database_->prepare("INSERT INTO lines VALUES (?, ?)"));
  const std::span<const std::uint8_t> bytes{reinterpret_cast<const std::uint8_t*>(line.data()),
                                            line.size() * sizeof(LinePlace)};
  return put.bind(row.name).bind(bytes).run();
}

Result<void> ResultWriter::finish() {
  BITELINE_TRY(database_->execute("COMMIT"));
  const fs::path beside = database_->file();
  database_.reset();
  std::error_code error;
  fs::permissions(
      beside, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read | fs::perms::others_read,
      error);
  if (std::rename(beside.c_str(), file_.c_str()) != 0)
    return fail_errno(Errc::WriteFailed, errno, "%s", file_.c_str());
  return {};
}

Result<void> write_baseline(const fs::path& file, const ResultSet& results) {
  std::string rows;
  for (std::size_t i = 0; i < results.rows().size(); ++i) {
    const ResultRow& row = results.rows()[i];
    ordered_json json{{"name", row.name}, {"kind", row.kind}, {"hash", row.hash}};
    json.update(to_json(row.outcome));
    json.erase("line_hash");  // the last digits differ from compiler to compiler
    BITELINE_ASSIGN(const std::vector<LinePlace> line, results.line(i));
    const std::size_t step = line.size() / k_most_pinned_points + 1;
    for (std::size_t p = 0; p < line.size(); p += step) {
      json["line"].push_back({to_microns(line[p].x_mm), to_microns(line[p].y_mm), to_microns(line[p].z_mm),
                              to_microns(line[p].u95_mm)});
    }
    rows += (rows.empty() ? "  " : ",\n  ") + report::to_text(json, -1);
  }
  // A recording a line: a change of one is one changed line.
  const ordered_json head{
      {"schema_version", 1}, {"build", results.run().build}, {"settings", results.run().settings}};
  std::string text = report::to_text(head, -1);
  text.pop_back();
  return write_shared_file(file, text + ", \"recordings\": [\n" + rows + "\n]}\n");
}

}  // namespace biteline::batch
