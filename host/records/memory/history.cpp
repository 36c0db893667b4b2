// SPDX-License-Identifier: MIT
#include "host/records/memory/history.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace biteline::memory {
namespace {

/// Quoted where CSV needs it; a cell that a spreadsheet would take for a formula begins with a quote mark.
std::string cell(std::string text) {
  if (!text.empty() && std::string_view{"=+-@\t\r"}.find(text.front()) != std::string_view::npos)
    text.insert(text.begin(), '\'');
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"') quoted += '"';
    quoted += letter;
  }
  return quoted + "\"";
}

std::string cell(const std::optional<double>& number) {
  if (!number) return {};
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", *number);
  return text;
}

std::string yes(bool value) {
  return value ? "yes" : "no";
}

nlohmann::ordered_json or_null(const std::optional<double>& number) {
  return number ? nlohmann::ordered_json(*number) : nlohmann::ordered_json{};
}

}  // namespace

Result<std::string> history_csv(const Memory& memory, ScanFilter filter) {
  std::string csv =
      "time,scan,model,model_probability,verdict,reason_code,length_mm,confidence,u95_mm,weak_stretches,scan_"
      "s,"
      "line_s,cycle_s,process,decision,decided_by,sent,followed,operator,line_version,reason\r\n";
  filter.before_id = 0;
  filter.limit = k_most_scans;
  while (true) {
    BITELINE_ASSIGN(const ScanPage page, memory.scans(filter));
    for (const Scan& scan : page.scans) {
      const std::string cells[] = {to_iso(scan.time),        cell(scan.name),
                                   cell(scan.model),         cell(scan.model_probability),
                                   cell(scan.verdict),       cell(scan.reason_code),
                                   cell(scan.length_mm),     cell(scan.confidence),
                                   cell(scan.u95_mm),        std::to_string(scan.weak_stretches),
                                   cell(scan.scan_s),        cell(scan.line_s),
                                   cell(scan.cycle_s),       cell(scan.process),
                                   cell(scan.decision),      cell(scan.decided_by),
                                   yes(scan.sent),           scan.followed ? yes(*scan.followed) : "",
                                   cell(scan.operator_name), std::to_string(scan.line_version),
                                   cell(scan.reason)};
      for (std::size_t i = 0; i < std::size(cells); ++i) csv += (i == 0 ? "" : ",") + cells[i];
      csv += "\r\n";
    }
    if (page.next_id == 0) return csv;
    filter.before_id = page.next_id;
  }
}

nlohmann::ordered_json to_json(const Trends& trends) {
  nlohmann::ordered_json json{{"buckets", nlohmann::ordered_json::array()},
                              {"reasons", nlohmann::ordered_json::array()}};
  for (const Trend& trend : trends.buckets) {
    json["buckets"].push_back({{"time", to_iso(trend.begin)},
                               {"scans", trend.scans},
                               {"ok", trend.ok},
                               {"amber", trend.amber},
                               {"refused", trend.refused},
                               {"failed", trend.failed},
                               {"cycle_s", or_null(trend.median_cycle_s)},
                               {"u95_mm", or_null(trend.median_u95_mm)},
                               {"length_mm", or_null(trend.mean_length_mm)}});
  }
  for (const ReasonCount& reason : trends.reasons)
    json["reasons"].push_back({{"reason_code", reason.reason_code}, {"scans", reason.scans}});
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
