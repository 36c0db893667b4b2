// SPDX-License-Identifier: MIT
#pragma once
/// \file Which closed crease is the bite line, how sure that is, and when the honest answer is that there is
/// none.

#include <cstddef>
#include <string>
#include <vector>

#include "host/bite_line/path/creases.hpp"

namespace biteline::bite_line {

struct Decision {
  bool accepted{false};
  std::string reason;   ///< one plain sentence when not accepted
  std::size_t best{0};  ///< index of the crease that is the line, or would be
  double confidence{0};
  std::vector<std::size_t> order;     ///< creases, best first
  std::vector<double> confidence_of;  ///< per crease, in the order of the input
};

/// What a bite line is: a crease all the way round; below it the sole stands out, or at least does not lie
/// back; and of several such creases the highest one, since decoration that runs all the way round sits on
/// the sole (parallel grooves, foxing stripes, treads) while what decorates the upper ends somewhere.  A
/// groove below a sole's edge is none, even where that edge is filled too far to be the line: then there is
/// none.
[[nodiscard]] Decision decide(const std::vector<Crease>& creases, double min_confidence);

}  // namespace biteline::bite_line
