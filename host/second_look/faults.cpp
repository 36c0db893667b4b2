// SPDX-License-Identifier: MIT
#include "host/second_look/faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/second_look/told_along.hpp"

namespace biteline::second_look {
namespace {

struct Open {
  FaultKind kind;
  std::size_t first, last;  ///< rows; beyond the number of them where it goes over the first one
  double low_mm, high_mm;
};

bool overlap(const Open& open, const Seen& seen) {
  return open.kind == seen.kind && seen.low_mm <= open.high_mm && open.low_mm <= seen.high_mm;
}

/// The row to begin at: one where nothing is wrong, if there is any.
std::size_t quiet_row(const SeenAt& seen, const RowsOnLine& rows) {
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i].empty() && rows.blank[i] == 0) return i;
  return 0;
}

struct Length {
  Arc arc, within;
  double mm;
};
/// From the middle between the last good row and the first bad one to the middle between the last bad one and
/// the next good one.
Length length_of(const Open& open, const RowsOnLine& rows) {
  const std::size_t count = rows.size();
  std::size_t before = 1, behind = 1;
  while (before < count && rows.blank[(open.first + count - before) % count] != 0) ++before;
  while (behind < count && rows.blank[(open.last + behind) % count] != 0) ++behind;
  const std::size_t first = open.first % count, last = open.last % count;
  const double back_mm = 0.5 * rows.way_mm((open.first + count - before) % count, first),
               on_mm = 0.5 * rows.way_mm(last, (open.last + behind) % count);
  const double inner_mm = first == last ? 0 : rows.way_mm(first, last);
  if (open.last - open.first + 1 >= count)
    return {.arc = {.from_mm = 0, .to_mm = rows.line_mm},
            .within = {.from_mm = 0, .to_mm = rows.line_mm},
            .mm = rows.line_mm};
  const auto on_line = [&](double mm) { return std::fmod(mm + rows.line_mm, rows.line_mm); };
  return {.arc = {.from_mm = on_line(rows.along_mm[first] - back_mm),
                  .to_mm = on_line(rows.along_mm[last] + on_mm)},
          .within = {.from_mm = on_line(rows.along_mm[first] - 2 * back_mm),
                     .to_mm = on_line(rows.along_mm[last] + 2 * on_mm)},
          .mm = back_mm + inner_mm + on_mm};
}

}  // namespace

const char* name_of(FaultKind kind) {
  static constexpr std::array k_names{"missing", "narrow", "wide", "beside", "doubled"};
  return k_names[static_cast<std::size_t>(kind)];
}

const char* words_of(Unclear why) {
  return why == Unclear::NotSeen ? "too few points in one of the scans"
                                 : "worked and unworked surface are too alike";
}

std::vector<Fault> join_faults(const SeenAt& seen, const RowsOnLine& rows, const LineFrame& frame,
                               const SurfaceWays& ways) {
  std::vector<Open> open, done;
  const std::size_t begin = quiet_row(seen, rows);
  for (std::size_t k = begin; k < begin + seen.size(); ++k) {
    const std::size_t i = k % seen.size();
    if (rows.blank[i] != 0) continue;
    std::vector<Open> going;
    for (const Seen& s : seen[i]) {
      const auto same = std::ranges::find_if(open, [&](const Open& o) { return overlap(o, s); });
      Open on{.kind = s.kind, .first = k, .last = k, .low_mm = s.low_mm, .high_mm = s.high_mm};
      if (same != open.end()) {
        on.first = same->first;
        on.low_mm = std::min(on.low_mm, same->low_mm);
        on.high_mm = std::max(on.high_mm, same->high_mm);
        open.erase(same);
      }
      going.push_back(on);
    }
    done.insert(done.end(), open.begin(), open.end());
    open = std::move(going);
  }
  done.insert(done.end(), open.begin(), open.end());
  std::vector<Fault> faults;
  for (const Open& o : done) {
    const Length length = length_of(o, rows);
    if (length.mm < k_least_told_mm) continue;
    const std::size_t middle = frame.nearest(rows.along_mm[(o.first + o.last) / 2 % seen.size()]);
    faults.push_back({.kind = o.kind,
                      .along = length.arc,
                      .within = length.within,
                      .low_mm = o.low_mm,
                      .high_mm = o.high_mm,
                      .middle_base = ways.point(frame.at(middle), middle, (o.low_mm + o.high_mm) / 2)});
  }
  std::ranges::sort(faults, {}, [](const Fault& f) { return f.along.from_mm; });
  return faults;
}

std::vector<CannotTell> join_unclear(const std::vector<BandPlace>& places, const RowsOnLine& rows) {
  std::vector<CannotTell> stretches;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i].unclear) continue;
    const bool goes_on = i > 0 && places[i - 1].unclear == places[i].unclear;
    const double before_mm = i > 0 ? rows.way_mm(i - 1, i) : 0,
                 behind_mm = i + 1 < places.size() ? rows.way_mm(i, i + 1) : 0;
    if (!goes_on)
      stretches.push_back(
          {.along = {.from_mm = places[i].along_mm - before_mm / 2}, .why = *places[i].unclear});
    stretches.back().along.to_mm = places[i].along_mm + behind_mm / 2;
  }
  return stretches;
}

}  // namespace biteline::second_look
