// SPDX-License-Identifier: MIT
#pragma once
/// \file Interval of a share of points.  Points of one shoe are off together, so shoes and not points are
/// drawn anew (bootstrap of clusters).

#include <array>
#include <vector>

namespace biteline::bench {

/// What one shoe adds to a share.
struct ShoeShare {
  double part{0}, whole{0};
};

/// Middle 95 % of sum of parts over sum of wholes, over a thousand draws of as many shoes.  Zeros where no
/// shoe has a whole.
[[nodiscard]] std::array<double, 2> drawn_anew(const std::vector<ShoeShare>& shoes);

}  // namespace biteline::bench
