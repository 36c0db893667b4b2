// SPDX-License-Identifier: MIT
#include "host/records/memory/history.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "common/core/fixed_text.hpp"

namespace biteline::memory {
namespace {

/// Writes the cells of one table.
class Cells {
 public:
  explicit Cells(const CsvStyle& style) : style_{style} {}

  /// Quoted where CSV needs it; one that a spreadsheet would take for a formula begins with a quote mark.
  [[nodiscard]] std::string of(std::string text) const {
    if (!text.empty() && std::string_view{"=+-@\t\r"}.find(text.front()) != std::string_view::npos)
      text.insert(text.begin(), '\'');
    const std::string special = std::string{"\"\r\n,;\t"} + style_.separator;
    if (text.find_first_of(special) == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char letter : text) {
      if (letter == '"') quoted += '"';
      quoted += letter;
    }
    return quoted + "\"";
  }
  [[nodiscard]] std::string of(const std::optional<double>& number) const {
    if (!number || !std::isfinite(*number)) return {};
    std::string text{FixedText<32>::format("%.6g", *number).view()};
    std::ranges::replace(text, '.', style_.decimal);
    return text;
  }

 private:
  const CsvStyle& style_;
};

std::string yes(bool value) {
  return value ? "yes" : "no";
}

/// Nothing where no look was asked for.
std::string count_of(const Work& work, int stretches) {
  return work.verdict.empty() ? std::string{} : std::to_string(stretches);
}

nlohmann::ordered_json or_null(const std::optional<double>& number) {
  return number ? nlohmann::ordered_json(*number) : nlohmann::ordered_json{};
}

}  // namespace

std::optional<CsvStyle> csv_style(const std::string& separator, const std::string& decimal, bool byte_mark) {
  CsvStyle style{.separator = 0, .decimal = 0, .byte_mark = byte_mark};
  for (const auto& [name, letter] :
       {std::pair{"comma", ','}, std::pair{"semicolon", ';'}, std::pair{"tab", '\t'}})
    if (separator == name) style.separator = letter;
  for (const auto& [name, letter] : {std::pair{"point", '.'}, std::pair{"comma", ','}})
    if (decimal == name) style.decimal = letter;
  if (style.separator == 0 || style.decimal == 0 || style.separator == style.decimal) return std::nullopt;
  return style;
}

Result<std::string> history_csv(const Memory& memory, ScanFilter filter, const CsvStyle& style,
                                const FactoryDay& day) {
  // New columns come at the end.
  constexpr std::array k_columns{"time",
                                 "scan",
                                 "model",
                                 "model_probability",
                                 "verdict",
                                 "reason_code",
                                 "length_mm",
                                 "confidence",
                                 "u95_mm",
                                 "weak_stretches",
                                 "scan_s",
                                 "line_s",
                                 "cycle_s",
                                 "process",
                                 "decision",
                                 "decided_by",
                                 "sent",
                                 "followed",
                                 "operator",
                                 "line_version",
                                 "reason",
                                 "local_time",
                                 "day",
                                 "part",
                                 "foot",
                                 "size",
                                 "ended_by",
                                 "tip_bound_mm",
                                 "work",
                                 "work_reworked",
                                 "work_missing_mm",
                                 "work_narrow",
                                 "work_wide",
                                 "work_beside",
                                 "work_doubled",
                                 "follows"};
  const Cells cell{style};
  std::string csv = style.byte_mark ? "\xEF\xBB\xBF" : "";
  for (std::size_t i = 0; i < k_columns.size(); ++i) {
    if (i > 0) csv += style.separator;
    csv += k_columns[i];
  }
  csv += "\r\n";
  filter.before_id = 0;
  filter.limit = k_most_scans;
  while (true) {
    BITELINE_ASSIGN(const ScanPage page, memory.scans(filter));
    for (const Scan& scan : page.scans) {
      const std::array<std::string, k_columns.size()> cells{
          to_iso(scan.time),
          cell.of(scan.name),
          cell.of(scan.model),
          cell.of(scan.model_probability),
          cell.of(scan.verdict),
          cell.of(scan.reason_code),
          cell.of(scan.length_mm),
          cell.of(scan.confidence),
          cell.of(scan.u95_mm),
          std::to_string(scan.weak_stretches),
          cell.of(scan.scan_s),
          cell.of(scan.line_s),
          cell.of(scan.cycle_s),
          cell.of(scan.process),
          cell.of(scan.decision),
          cell.of(scan.decided_by),
          yes(scan.sent),
          scan.followed ? yes(*scan.followed) : "",
          cell.of(scan.operator_name),
          std::to_string(scan.line_version),
          cell.of(scan.reason),
          local_time(scan.time),
          day.name_of(scan.time),
          cell.of(scan.part),
          cell.of(scan.foot),
          cell.of(scan.size),
          report::name_of(ended_by(scan)),
          cell.of(scan.tip_bound_mm),
          cell.of(scan.work.verdict),
          scan.work.verdict.empty() ? "" : yes(scan.work.reworked),
          cell.of(scan.work.missing_mm),
          count_of(scan.work, scan.work.narrow),
          count_of(scan.work, scan.work.wide),
          count_of(scan.work, scan.work.beside),
          count_of(scan.work, scan.work.doubled),
          cell.of(scan.follows)};
      for (std::size_t i = 0; i < cells.size(); ++i) {
        if (i > 0) csv += style.separator;
        csv += cells[i];
      }
      csv += "\r\n";
    }
    if (page.next_id == 0) return csv;
    filter.before_id = page.next_id;
  }
}

report::EndedBy ended_by(const Scan& scan) {
  using report::EndedBy;
  if (scan.decision == "rejected") return EndedBy::Person;
  if (scan.decision == "held" || scan.verdict == "working" || scan.verdict == "review")
    return EndedBy::Nobody;
  if (scan.verdict == "failed") return EndedBy::Machine;
  const EndedBy who = report::ended_by(scan.reason_code);
  return scan.verdict == "refused" && who == EndedBy::Nobody ? EndedBy::Shoe : who;
}

nlohmann::ordered_json to_json(const Trends& trends) {
  nlohmann::ordered_json json{{"buckets", nlohmann::ordered_json::array()},
                              {"reasons", nlohmann::ordered_json::array()}};
  for (const Trend& trend : trends.buckets) {
    json["buckets"].push_back({{"time", to_iso(trend.begin)},
                               {"scans", trend.scans},
                               {"ok", trend.ok},
                               {"amber", trend.amber},
                               {"review", trend.review},
                               {"refused", trend.refused},
                               {"failed", trend.failed},
                               {"cycle_s", or_null(trend.median_cycle_s)},
                               {"u95_mm", or_null(trend.median_u95_mm)},
                               {"length_mm", or_null(trend.mean_length_mm)}});
  }
  using report::EndedBy;
  std::map<EndedBy, std::int64_t> ended{{EndedBy::Person, trends.stopped}};
  for (const ReasonCount& reason : trends.reasons) {
    const EndedBy who = report::ended_by(reason.reason_code);
    ended[who] += reason.scans;
    json["reasons"].push_back(
        {{"reason_code", reason.reason_code},
         {"scans", reason.scans},
         {"ended_by",
          who == EndedBy::Nobody ? nlohmann::ordered_json{} : nlohmann::ordered_json(report::name_of(who))}});
  }
  for (const EndedBy who : {EndedBy::Person, EndedBy::Machine, EndedBy::Shoe})
    json["ended_by"][report::name_of(who)] = ended[who];
  return json;
}

std::optional<Capability> capability_of(const PlaceSums& sums, double tolerance_mm) {
  if (sums.scans < 2) return std::nullopt;
  constexpr double k_least_spread_mm = 0.001;
  const auto n = static_cast<double>(sums.scans);
  Capability capability;
  for (std::size_t i = 0; i < k_places; ++i) {
    const double mean = sums.sum_mm[i] / n;
    const double variance = std::max(0.0, (sums.sum_mm2[i] - n * mean * mean) / (n - 1));
    const double spread = std::max(k_least_spread_mm, std::sqrt(variance));
    capability.pp.push_back(tolerance_mm / (3 * spread));
    capability.ppk.push_back((tolerance_mm - std::abs(mean)) / (3 * spread));
  }
  return capability;
}

}  // namespace biteline::memory
