// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a course leaves its crease.

#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/layers/layers.hpp"
#include "host/bite_line/level/patch.hpp"
#include "host/bite_line/level/step_costs.hpp"
#include "host/bite_line/side/side_field.hpp"

namespace biteline::bite_line {

/// Columns where the course shows no crease, or lies on another one; the first may lie beyond the last.
struct CourseGap {
  int first, cols;
  bool changes{false};  ///< lies on another crease somewhere in it
};

struct GapConfig {
  double least_mm;           ///< shorter ones are none
  double least_turn_rad{0};  ///< a crease that turns by less counts as none
  double island_mm{4};       ///< what shows a crease for less between two gaps is noise
};

/// Once round, from behind a stretch that shows its crease; none where no such stretch is.
[[nodiscard]] std::vector<CourseGap> gaps_of(const SideGrid& grid, const Layers& layers,
                                             const GapConfig& config);

/// A course over s, which may go beyond the outline's length.
class CourseOverS {
 public:
  /// Both borrowed.
  CourseOverS(const SideGrid& grid, const Crease& line) : grid_{grid}, line_{line} {}

  [[nodiscard]] double z_mm(double s_mm) const;
  /// How far it rises over a gap beyond what its ends' slopes tell; 0 where that is below 2 mm.
  [[nodiscard]] double jump_mm(const CourseGap& gap) const;
  /// Of a place (s, z) from it, as far as 12 mm along it tell.
  [[nodiscard]] double off_mm(const Vec2& place) const;
  /// As a way over the patch.
  [[nodiscard]] double cost(const Patch& patch, const StepCosts& costs, double from_mm, double to_mm) const;

 private:
  const SideGrid& grid_;
  const Crease& line_;
};

}  // namespace biteline::bite_line
