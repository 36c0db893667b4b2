// SPDX-License-Identifier: MIT
#pragma once
/// \file The history as tables: CSV of all, trends as JSON, capability of a model's line.

#include <nlohmann/json.hpp>

#include "host/records/memory/factory_day.hpp"
#include "host/records/memory/memory.hpp"
#include "host/report/ended_by.hpp"

namespace biteline::memory {

/// How a table for people is written: each country's spreadsheet takes another one for its own.
struct CsvStyle {
  char separator{','};
  char decimal{'.'};
  bool byte_mark{false};  ///< U+FEFF first, by which Excel knows UTF-8
};
/// "comma", "semicolon" or "tab"; "point" or "comma".  Nothing: none of them, or both the same letter.
[[nodiscard]] std::optional<CsvStyle> csv_style(const std::string& separator, const std::string& decimal,
                                                bool byte_mark);

/// Every scan of the filter, newest first, a row each, with a heading (RFC 4180).  The filter's limit and
/// cursor do not count.  `time` is UTC; `local_time` and `day` are the factory's.
[[nodiscard]] Result<std::string> history_csv(const Memory& memory, ScanFilter filter,
                                              const CsvStyle& style = {}, const FactoryDay& day = {});

/// Who ended it, by its row; Nobody: it came to its end, or is still in work or held.
[[nodiscard]] report::EndedBy ended_by(const Scan& scan);

/// `buckets`, `reasons`, and in `ended_by` how many scans a person, the machine and the shoe have ended.
[[nodiscard]] nlohmann::ordered_json to_json(const Trends& trends);

/// Of the line's distance to the model's line, at each place.  Pp = T / (3 s), Ppk = (T - |m|) / (3 s), with
/// tolerance +-T, mean m and standard deviation s of all scans (ISO 22514-2).
struct Capability {
  std::vector<double> pp, ppk;
};
/// Nothing with fewer than two scans.  A spread of 0 counts as 1 um: what a place is written with.
[[nodiscard]] std::optional<Capability> capability_of(const PlaceSums& sums, double tolerance_mm);

}  // namespace biteline::memory
