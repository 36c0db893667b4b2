// SPDX-License-Identifier: MIT
#pragma once
/// \file Which closed crease is the bite line, how sure that is, and when the honest answer is that there is
/// none.

#include <cstddef>
#include <optional>
#include <vector>

#include "host/bite_line/path/creases.hpp"
#include "host/bite_line/refused.hpp"

namespace biteline::bite_line {

/// A closed path that was judged.
struct JudgedPath {
  double confidence{0};     ///< 0 to 1, in comparison with its rivals
  std::vector<double> row;  ///< per column, in rows of the side's grid
  double mean_height_mm{0};
  double closure_mm{0};
  double turn_rad{0};    ///< median turn of the surface across it
  double seen_share{0};  ///< of its columns
};

struct Decision {
  std::optional<Refusal> refusal;  ///< why none is the bite line
  double confidence{0};            ///< of the best path, or that it is the line all the same
  std::vector<JudgedPath> paths;   ///< best first
};

/// What a bite line is: a crease all the way round; below it the sole stands out, or at least does not lie
/// back; and of several such creases the highest one, since decoration that runs all the way round sits on
/// the sole (parallel grooves, foxing stripes, treads) while what decorates the upper ends somewhere.  A
/// groove below a sole's edge is none, even where that edge is filled too far to be the line: then there is
/// none.
[[nodiscard]] Decision decide(const std::vector<Crease>& creases, double min_confidence);

}  // namespace biteline::bite_line
