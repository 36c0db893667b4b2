// SPDX-License-Identifier: MIT
#pragma once
/// \file The line as its gates judge it: its crease, how far it holds, and what else it could be.

#include <vector>

#include "host/bite_line/path/creases.hpp"

namespace biteline::bite_line {

/// Another layer: it lies beside the line over a part of its length, or all the way round.
struct Rival {
  Crease crease;  ///< the line, but for the columns where this one parts from it
  int first_col{0};
  int cols{0};
  bool above{false};
  bool all_round{false};
};

struct Layers {
  Crease line;
  std::vector<float> hold;      ///< per column: that the line is on its layer and on no other, 0 to 1
  std::vector<float> other_mm;  ///< per column: how far off the layer lies that the line holds least against
  std::vector<float> sharp;     ///< per column: how sharp a place the crease has, 1 but on flat weak ones
  std::vector<Rival> rivals;    ///< the longest first
};

/// Per column of a path: how sharp a place its crease has.
[[nodiscard]] std::vector<float> sharp_along(const SideField& field, const Crease& line);

}  // namespace biteline::bite_line
