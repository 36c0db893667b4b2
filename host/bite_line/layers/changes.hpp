// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a course leaves one crease for another in plain sight, and which part of it that makes unsure.

#include <span>
#include <vector>

#include "host/bite_line/layers/course.hpp"
#include "host/bite_line/side/side_field.hpp"

namespace biteline::bite_line {

/// Between two creases the surface turns as little as anywhere, and a course that crosses from one to the
/// other goes on at another height than it came from.
struct LayerChange {
  int col{0};
  double rise_mm{0};  ///< of its direction behind the column over the one before it, there
};

struct ChangeConfig {
  float off_crease_ratio{0.25F};  ///< of the course's usual turn: a place on no crease
  double half_mm{5.0};            ///< to both sides of its middle
  double lever_mm{10.0};          ///< beyond that, of the directions
  double least_mm{2.0};           ///< what is nearer is the same line
};

/// In the order of the columns; `path`: row per column.  What was not seen tells nothing.
[[nodiscard]] std::vector<LayerChange> layer_changes(const SideField& field, std::span<const int> path,
                                                     const ChangeConfig& config);

/// A stretch of columns, modulo their number, on another crease than the rest.
struct OtherCrease {
  int first_col{0};
  int cols{0};
  double off_mm{0};
};

/// A course that leaves its crease comes back to it: with the opposite step, where a stretch was not seen, or
/// else by and by, where its height is back.  The shorter way between the two is the part on another crease.
///
/// Without any of these the two creases meet.  Then one of the other ways (`branches`) begins or ends at the
/// change and keeps to the crease that the course left there, or is on the one that it came to already: that
/// part is unsure until they meet.  Without such a way it is unsure for 100 mm on both sides.
[[nodiscard]] std::vector<OtherCrease> other_creases(const SideField& field, std::span<const int> path,
                                                     std::span<const LayerChange> changes,
                                                     const ChangeConfig& config,
                                                     std::span<const Branch> branches);

}  // namespace biteline::bite_line
