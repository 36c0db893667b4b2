// SPDX-License-Identifier: MIT
// Scans counted and averaged over spans of time.
#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "host/records/memory/factory_day.hpp"
#include "host/records/memory/memory.hpp"
#include "host/records/memory/scan_filter.hpp"

namespace biteline::memory {
namespace {

std::optional<double> median(std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

struct Bucket {
  Trend trend;
  double length_mm{0};
  std::int64_t lengths{0};
  std::vector<double> u95_mm, cycle_s;

  void add(const Statement& row) {
    ++trend.scans;
    const std::string verdict = row.text(1);
    trend.ok += verdict == "ok" ? 1 : 0;
    trend.amber += verdict == "amber" ? 1 : 0;
    trend.review += verdict == "review" ? 1 : 0;
    trend.refused += verdict == "refused" ? 1 : 0;
    trend.failed += verdict == "failed" ? 1 : 0;
    if (!row.is_null(2)) {
      length_mm += row.number(2);
      ++lengths;
    }
    if (!row.is_null(3)) u95_mm.push_back(row.number(3));
    if (!row.is_null(4)) cycle_s.push_back(row.number(4));
  }
  Trend close() {
    if (lengths > 0) trend.mean_length_mm = length_mm / static_cast<double>(lengths);
    trend.median_u95_mm = median(u95_mm);
    trend.median_cycle_s = median(cycle_s);
    return trend;
  }
};

/// A scan that a person ended on its way says nothing of a shoe.
void leave_out_stopped(Where& where) {
  where.add("NOT (verdict = 'refused' AND reason_code = ?)", std::string{k_stopped_by_a_person});
}

}  // namespace

Result<Trends> Memory::trends(const ScanFilter& filter, const FactoryDay& day, Span span) const {
  const std::lock_guard lock{*mutex_};
  Trends trends;
  Where all = where_of(filter), stopped = all;
  leave_out_stopped(all);
  Where where = all;
  where.add("follows = ?", std::string{});
  stopped.add("verdict = ?", std::string{"refused"});
  stopped.add("reason_code = ?", std::string{k_stopped_by_a_person});
  BITELINE_ASSIGN(Statement count, database_->prepare("SELECT count(*) FROM scans" + stopped.sql));
  stopped.bind_to(count);
  BITELINE_TRY(count.step());
  trends.stopped = count.integer(0);
  // In the order of an index that has all of these columns: one GROUP BY would sort every row first.
  BITELINE_ASSIGN(Statement rows,
                  database_->prepare("SELECT time, verdict, length_mm, u95_mm, cycle_s FROM scans" +
                                     where.sql + " ORDER BY time"));
  where.bind_to(rows);
  Bucket bucket;
  Interval around;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) break;
    const UnixMs time = rows.integer(0);
    if (time < around.begin || time >= around.end) {
      if (bucket.trend.scans > 0) trends.buckets.push_back(bucket.close());
      bucket = Bucket{};
      around = day.around(time, span);
      bucket.trend.begin = around.begin;
    }
    bucket.add(rows);
  }
  if (bucket.trend.scans > 0) trends.buckets.push_back(bucket.close());
  Where refused = all;
  refused.add("reason_code > ?", std::string{});
  BITELINE_ASSIGN(Statement reasons, database_->prepare("SELECT reason_code, count(*) FROM scans" +
                                                        refused.sql + " GROUP BY 1 ORDER BY 2 DESC, 1"));
  refused.bind_to(reasons);
  while (true) {
    BITELINE_ASSIGN(const bool row, reasons.step());
    if (!row) return trends;
    trends.reasons.push_back({.reason_code = reasons.text(0), .scans = reasons.integer(1)});
  }
}

Result<PlaceSums> Memory::place_sums(const std::string& model, std::optional<UnixMs> from,
                                     std::optional<UnixMs> to) const {
  const std::lock_guard lock{*mutex_};
  BITELINE_ASSIGN(Statement rows,
                  database_->prepare("SELECT places FROM scan_places WHERE model = ? AND time >= ? "
                                     "AND time < ?"));
  rows.bind(model).bind(from.value_or(0)).bind(to.value_or(std::numeric_limits<std::int64_t>::max()));
  PlaceSums sums;
  while (true) {
    BITELINE_ASSIGN(const bool row, rows.step());
    if (!row) return sums;
    const std::span<const std::uint8_t> bytes = rows.bytes(0);
    if (bytes.size() != sizeof(Places)) continue;
    Places places{};
    std::memcpy(places.data(), bytes.data(), sizeof places);
    ++sums.scans;
    for (std::size_t i = 0; i < k_places; ++i) {
      const double mm = places[i];
      sums.sum_mm[i] += mm;
      sums.sum_mm2[i] += mm * mm;
    }
  }
}

}  // namespace biteline::memory
