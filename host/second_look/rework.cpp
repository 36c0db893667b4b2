// SPDX-License-Identifier: MIT
#include "host/second_look/rework.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::second_look {
namespace {

/// A path begins and ends at samples of the line, within half of 0.1 mm.
constexpr double k_end_mm = k_most_twice_mm - 0.05;

double on_line(double mm, double line_mm) {
  return std::fmod(std::fmod(mm, line_mm) + line_mm, line_mm);
}

double length_mm(const Arc& arc, double line_mm) {
  return on_line(arc.to_mm - arc.from_mm, line_mm);
}

/// What of the band's width is there beside the fault.
double there_mm(const Fault& fault, const PlannedBand& plan) {
  return std::max(0.0, fault.low_mm - plan.low_mm) + std::max(0.0, plan.high_mm - fault.high_mm);
}

bool is_worked_again(const Fault& fault, const PlannedBand& plan, double line_mm, const ReworkWish& wish) {
  if (fault.kind != FaultKind::Missing && fault.kind != FaultKind::Narrow) return false;
  if (fault.along.to_mm - fault.along.from_mm >= line_mm) return false;
  return wish.narrow || there_mm(fault, plan) <= k_most_twice_mm;
}

/// The ends lie half way to the next profiles: its first and last bad ones as far on the other side.
Arc piece_of(const Fault& fault, double line_mm) {
  const double back_mm =
                   2 * length_mm({.from_mm = fault.within.from_mm, .to_mm = fault.along.from_mm}, line_mm),
               on_mm = 2 * length_mm({.from_mm = fault.along.to_mm, .to_mm = fault.within.to_mm}, line_mm);
  return {.from_mm = on_line(fault.within.from_mm + std::max(0.0, back_mm - k_end_mm), line_mm),
          .to_mm = on_line(fault.within.to_mm - std::max(0.0, on_mm - k_end_mm), line_mm)};
}

/// The second begins within the first.
bool meet(const Arc& a, const Arc& b, double line_mm) {
  return length_mm({.from_mm = a.from_mm, .to_mm = b.from_mm}, line_mm) <= length_mm(a, line_mm);
}

/// The second one's end counts where it lies behind the first one's.
void join(ReworkPiece& first, const ReworkPiece& second, double line_mm) {
  const double whole_mm = length_mm({.from_mm = first.along.from_mm, .to_mm = second.along.to_mm}, line_mm);
  if (whole_mm > length_mm(first.along, line_mm)) first.along.to_mm = second.along.to_mm;
  first.faults.insert(first.faults.end(), second.faults.begin(), second.faults.end());
}

}  // namespace

Rework rework_of(const std::vector<Fault>& faults, const PlannedBand& plan, double line_mm,
                 const ReworkWish& wish) {
  Rework rework;
  std::vector<ReworkPiece> pieces;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (is_worked_again(faults[i], plan, line_mm, wish))
      pieces.push_back({.along = piece_of(faults[i], line_mm), .faults = {i}});
    else
      rework.for_a_person.push_back(i);
  }
  std::ranges::sort(pieces, {}, [](const ReworkPiece& piece) { return piece.along.from_mm; });
  for (const ReworkPiece& piece : pieces) {
    if (!rework.pieces.empty() && meet(rework.pieces.back().along, piece.along, line_mm))
      join(rework.pieces.back(), piece, line_mm);
    else
      rework.pieces.push_back(piece);
  }
  // The last one may go over the line's first point into the first one.
  if (rework.pieces.size() > 1 && meet(rework.pieces.back().along, rework.pieces.front().along, line_mm)) {
    join(rework.pieces.back(), rework.pieces.front(), line_mm);
    rework.pieces.erase(rework.pieces.begin());
  }
  return rework;
}

}  // namespace biteline::second_look
