// SPDX-License-Identifier: MIT
#include "host/records/memory/log_chain.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "host/records/digest/digest.hpp"
#include "host/records/memory/memory.hpp"
#include "host/report/report.hpp"

namespace biteline::memory {
namespace {

constexpr std::size_t k_link_digits = 64;
/// Far more links than anybody keeps.
constexpr std::size_t k_most_links = 100'000;

std::string name_of(const LogRow& row) {
  return FixedText<160>::format("row %" PRId64 " (%.60s, %s)", row.id, row.action.c_str(),
                                to_iso(row.time).c_str())
      .c_str();
}

/// Goes through the rows in their order.
class Chain {
 public:
  explicit Chain(std::span<const LogLink> kept) {
    for (const LogLink& link : kept) kept_.emplace(link.row, link.link);
  }

  void take(const LogRow& row, const std::string& link) {
    ++verdict_.rows;
    const std::string expected = link_of(before_, row);
    if (verdict_.first_linked == 0 && link.empty()) {
      ++verdict_.sealed;
      before_ = expected;
    } else {
      take_linked(row, link, expected);
    }
    last_row_ = row.id;
    compare_with_kept(row, link);
  }

  /// `written`: number of the newest row that was ever written.
  LogVerdict end(std::int64_t written) {
    if (written > last_row_)
      tell(LogRefused::Cut, last_row_ + 1,
           FixedText<120>::format("rows %" PRId64 " to %" PRId64 " are missing at the end", last_row_ + 1,
                                  written)
               .c_str());
    for (const auto& [row, link] : kept_)
      tell(LogRefused::Cut, row,
           FixedText<120>::format("row %" PRId64 ", whose link was kept, is missing", row).c_str());
    return std::move(verdict_);
  }

 private:
  void take_linked(const LogRow& row, const std::string& link, const std::string& expected) {
    const bool first = verdict_.first_linked == 0;
    if (first) verdict_.first_linked = row.id;
    if (!first && row.id != last_row_ + 1)
      tell(
          LogRefused::Changed, last_row_ + 1,
          FixedText<160>::format("row %" PRId64 " stands behind row %" PRId64 ": what was between is missing",
                                 row.id, last_row_)
              .c_str());
    else if (link != expected)
      tell(LogRefused::Changed, row.id,
           name_of(row) + (first && verdict_.sealed > 0 ? ": it, or a row before it, is not as it was written"
                                                        : ": not as it was written"));
    // Goes on with what stands there: the next fault is told by its own row.
    before_ = link;
    if (!link.empty()) verdict_.last = {.row = row.id, .link = link};
  }

  void compare_with_kept(const LogRow& row, const std::string& link) {
    const auto [begin, end] = kept_.equal_range(row.id);
    if (std::any_of(begin, end, [&](const auto& kept) { return kept.second != link; }))
      tell(LogRefused::Cut, row.id, name_of(row) + ": another link was kept of it");
    kept_.erase(begin, end);
  }

  void tell(LogRefused code, std::int64_t row, std::string what) {
    if (verdict_.faults.size() < LogVerdict::k_most_told)
      verdict_.faults.push_back({.code = code, .row = row, .what = std::move(what)});
    else
      ++verdict_.more_faults;
  }

  std::multimap<std::int64_t, std::string> kept_;  ///< by row; that were not met yet
  LogVerdict verdict_;
  std::string before_;
  std::int64_t last_row_{0};
};

LogRow row_in(const Statement& row) {
  return {.id = row.integer(0),
          .time = row.integer(1),
          .who = row.text(2),
          .door = row.text(3),
          .action = row.text(4),
          .subject = row.text(5),
          .before = row.text(6),
          .after = row.text(7)};
}

constexpr const char* k_all_rows =
    "SELECT id, time, who, door, action, subject, before, after, link FROM log ORDER BY id";

Result<std::int64_t> newest_written(Database& database) {
  BITELINE_ASSIGN(Statement row, database.prepare("SELECT seq FROM sqlite_sequence WHERE name = 'log'"));
  BITELINE_ASSIGN(const bool found, row.step());
  return found ? row.integer(0) : 0;
}

/// Of the newest row, or what seals a log of before the chain; empty: there is no row.
Result<std::string> newest_link(Database& database) {
  BITELINE_ASSIGN(Statement newest, database.prepare("SELECT link FROM log ORDER BY id DESC LIMIT 1"));
  BITELINE_ASSIGN(const bool found, newest.step());
  if (!found) return std::string{};
  if (std::string link = newest.text(0); !link.empty()) return link;
  // Once in a memory's life.
  BITELINE_ASSIGN(Statement rows, database.prepare(k_all_rows));
  std::string link;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return link;
    const std::string stored = rows.text(8);
    link = stored.empty() ? link_of(link, row_in(rows)) : stored;
  }
}

}  // namespace

std::span<const report::RefusalRow<LogRefused>> refusal_table(LogRefused) {
  using enum LogRefused;
  using Row = report::RefusalRow<LogRefused>;
  static constexpr std::array k_rows{
      Row{Changed, "log_changed", "ask who could write the file, and compare with a backup of before"},
      Row{Cut, "log_cut", "ask whether an older backup was put back; compare with a newer one"},
  };
  return k_rows;
}

bool is_log_link(std::string_view text) {
  return text.size() == k_link_digits && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

std::string link_of(const std::string& before, const LogRow& row) {
  Digest digest;
  digest.add_text(before).add_text(std::to_string(row.id)).add_text(std::to_string(row.time));
  digest.add_text(row.who).add_text(row.door).add_text(row.action).add_text(row.subject);
  return digest.add_text(row.before).add_text(row.after).hex();
}

Result<void> Memory::add_log(const LogRow& row) {
  LogRow written = row;
  if (written.time == 0) written.time = now_ms();
  BITELINE_ASSIGN(const std::int64_t newest, newest_written(*database_));
  written.id = newest + 1;
  BITELINE_ASSIGN(const std::string before, newest_link(*database_));
  BITELINE_ASSIGN(
      Statement insert,
      database_->prepare("INSERT INTO log (id, time, who, door, action, subject, before, after, link) "
                         "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)"));
  insert.bind(written.id).bind(written.time).bind(written.who).bind(written.door).bind(written.action);
  insert.bind(written.subject).bind(written.before).bind(written.after);
  return insert.bind(link_of(before, written)).run();
}

Result<void> Memory::log(const LogRow& row) {
  const std::lock_guard lock{*mutex_};
  return database_->transaction([&] { return add_log(row); });
}

Result<LogVerdict> Memory::verify_log(std::span<const LogLink> kept) const {
  const std::lock_guard lock{*mutex_};
  Chain chain{kept};
  // First the number, then the rows: what is written meanwhile is no fault.
  BITELINE_ASSIGN(const std::int64_t written, newest_written(*database_));
  BITELINE_ASSIGN(Statement rows, database_->prepare(k_all_rows));
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return chain.end(written);
    chain.take(row_in(rows), rows.text(8));
  }
}

Result<std::vector<LogLink>> read_kept_links(const std::filesystem::path& file) {
  std::vector<LogLink> links;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return links;
  std::ifstream in(file);
  if (!in || !std::filesystem::is_regular_file(file, error))
    return fail(Errc::FileUnreadable, "%.200s: no file of kept links", file.c_str());
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    std::istringstream words(line);
    LogLink link;
    if (!(words >> link.row >> link.link) || link.row < 1 || !is_log_link(link.link) ||
        links.size() == k_most_links)
      return fail(Errc::BadFormat, "%.200s line %d: ROW LINK TIME of biteline history --verify-log expected",
                  file.c_str(), number);
    links.push_back(std::move(link));
  }
  return links;
}

Result<void> keep_link(const std::filesystem::path& file, const LogLink& link) {
  BITELINE_ASSIGN(const std::vector<LogLink> kept, read_kept_links(file));
  if (std::ranges::find(kept, link) != kept.end()) return {};
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  std::string lines = text.str();
  if (!lines.empty() && lines.back() != '\n') lines += '\n';
  lines += std::to_string(link.row) + " " + link.link + " " + to_iso(now_ms()) + "\n";
  return report::write_file_atomically(file, lines);
}

}  // namespace biteline::memory
