// SPDX-License-Identifier: MIT
#pragma once
/// \file The memory's log as a hash chain: a row that was changed, dropped, put in or swapped is found.
///
/// A row's link is the SHA-256 of the link before it and of the row's number and fields, each with its
/// length. A log of before the chain is sealed by its first link: what was changed until then is not known.
/// The chain has no key.  Who can write the file can write another chain that fits, or cut the end: that is
/// found by who kept a link elsewhere.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/result.hpp"
#include "host/report/refusal.hpp"

namespace biteline::memory {

struct LogRow;

/// The link of one row.
struct LogLink {
  std::int64_t row{0};
  std::string link;  ///< 64 hex digits

  friend bool operator==(const LogLink&, const LogLink&) = default;
};

/// 64 hex digits.
[[nodiscard]] bool is_log_link(std::string_view text);

/// Of a row that stands behind `before` (empty: the first of all).  Its own id counts.
[[nodiscard]] std::string link_of(const std::string& before, const LogRow& row);

enum class LogRefused {
  Changed,  ///< rows are not as they were written, or rows are missing between others
  Cut,      ///< its end, or all of it, is not the log of which links were kept
};
[[nodiscard]] std::span<const report::RefusalRow<LogRefused>> refusal_table(LogRefused);

struct LogFault {
  LogRefused code{LogRefused::Changed};
  std::int64_t row{0};
  std::string what;  ///< "row 12 (settings, 2026-11-20T21:04:05.123Z): not as it was written"
};

struct LogVerdict {
  std::int64_t rows{0};
  std::int64_t first_linked{0};  ///< 0: no row has a link, the log is of before the chain
  std::int64_t sealed{0};        ///< rows of before the chain
  LogLink last;                  ///< of the newest row that has one
  std::vector<LogFault> faults;  ///< the first k_most_told
  std::int64_t more_faults{0};
  static constexpr std::size_t k_most_told = 100;
};

/// Links that were kept elsewhere: a line each, `ROW LINK`, and what else stands there (a time, a book)
/// is for people.  No file: none.  Fails for another line.
[[nodiscard]] Result<std::vector<LogLink>> read_kept_links(const std::filesystem::path& file);
/// Adds the verdict's last link unless it stands there.  Beside and renamed.
[[nodiscard]] Result<void> keep_link(const std::filesystem::path& file, const LogLink& link);

}  // namespace biteline::memory
