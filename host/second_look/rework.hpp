// SPDX-License-Identifier: MIT
#pragma once
/// \file Which of a second look's faults are worked once more, and from where to where.

#include <cstddef>
#include <vector>

#include "host/second_look/second_look.hpp"

namespace biteline::second_look {

/// Nothing that is there is worked again over more than this, along or across.
inline constexpr double k_most_twice_mm = 1;

/// What a person allows beyond it.
struct ReworkWish {
  bool narrow{false};  ///< also where more of the band's width is there: all of it is worked again
};

/// One piece of the line: all of its faults, and at each end at most k_most_twice_mm of what is there.
struct ReworkPiece {
  Arc along{};
  std::vector<std::size_t> faults{};  ///< by their places in the list
};

/// Sorted along the line.
struct Rework {
  std::vector<ReworkPiece> pieces{};
  /// Faults that no work removes (wide, beside, doubled), or only by working more than that twice.
  std::vector<std::size_t> for_a_person{};
};

/// A piece goes from the last profile before a fault that shows work to the first one behind it.  Pieces that
/// meet are one.  A fault that takes all of the line is the work itself, and a person's.
[[nodiscard]] Rework rework_of(const std::vector<Fault>& faults, const PlannedBand& plan, double line_mm,
                               const ReworkWish& wish);

}  // namespace biteline::second_look
