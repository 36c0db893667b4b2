// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a course leaves its crease, and one in another direction keeps to it.

#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/layers/layers.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

struct DetourConfig {
  double least_gap_mm{5};      ///< without a crease: shorter ones are left as they are
  double longest_gap_mm{120};  ///< longer ones without a change are no guard's
  /// Where it changes its crease or its height at once, the look goes so far to both sides, and no farther
  /// than half round.
  double beside_mm{100};
  double weak_ratio{0.35};   ///< of the line's usual turn: a crease so much weaker may be another one
  double most_bare_mm{4.5};  ///< a way that was seen and shows no crease over so much changes creases, too
  double most_unseen_mm{8};  ///< a way of which more was not seen makes the gap unsure at most
  double apart_mm{2.5};      ///< what is nearer to the course is the same line
  /// What goes farther away than this is told from the course with ease; nearer by, the way may follow a
  /// course that lies on the wrong crease.
  double far_mm{5};
  /// A way costs so little per millimetre of the gap, and the next best way more than it by so much per
  /// column.  Fitted to 370 made shoes with guards: of the wrong ways none passes, of the right ones nine of
  /// ten.
  double most_far_cost{0.3}, least_far_margin{0.16};
  double most_near_cost{0.15}, least_near_margin{0.6};
  /// Gaps with so short an island between them are one, too.  A far way over them may cost so much: it goes
  /// round a guard with a badge on it, and a high guard's edge is long for its gap.
  double longest_island_mm{8}, most_joined_cost{0.5};
  /// A far way up to so much makes the gap unsure; a dearer one tells nothing.
  double most_told_cost{0.4};
};

/// A stretch of a course; x is s along the outline, which may go beyond its length, y is z, mm, in shoe.
struct Detour {
  std::vector<Vec2> places;       ///< of the way, from a place of the course to a later one
  std::size_t first{0}, last{0};  ///< places between which it leaves the course
  bool sure{false};               ///< the line is on it; else the line is unsure between those places
  bool hidden{false};             ///< too much of it was not seen to say that it is the line
  double off_mm{0};               ///< how far it leads away from the course
};

/// A course runs along the outline and climbs by 45 degrees at most.  Where a sole wraps up over the toe as a
/// guard does, its edge stands upright.  There the course shows no crease, or changes to another one; the
/// cheapest way in any direction tells where the edge goes.  All are sure, or none is.
[[nodiscard]] std::vector<Detour> find_detours(const Side& side, const Layers& layers,
                                               const DetourConfig& config);

/// Makes the columns of what is not sure unsure.  Most of what hides is no guard's flank: such columns hardly
/// lose confidence, but their U95 reaches up to the way.
void doubt_detours(const SideGrid& grid, std::span<const Detour> detours, Layers& layers);

/// The course with its sure detours, once round: the first place's s is within the outline's length, and the
/// last one is joined to the first one, a whole outline on.  Empty where none is sure.
[[nodiscard]] std::vector<Vec2> guide_of(const Side& side, const Crease& line,
                                         std::span<const Detour> detours);

}  // namespace biteline::bite_line
