// SPDX-License-Identifier: MIT
#include "host/cloud/flagged.hpp"

#include <algorithm>

namespace biteline::cloud {

Flagged flagged_of(const ClosedLine& line, double min_confidence) {
  const double each = 1.0 / static_cast<double>(std::max<std::size_t>(line.points.size(), 1));
  Flagged flagged;
  for (const LinePoint& p : line.points) {
    if (!(p.confidence >= std::max(min_confidence, k_sure_ratio)))
      flagged.unsure += each;
    else if ((p.flags & k_line_unsure) != 0)
      flagged.uncertain += each;
  }
  return flagged;
}

double flagged_share(const ClosedLine& line) {
  const auto flagged =
      std::ranges::count_if(line.points, [](const LinePoint& p) { return (p.flags & k_line_unsure) != 0; });
  return static_cast<double>(flagged) / static_cast<double>(std::max<std::size_t>(line.points.size(), 1));
}

}  // namespace biteline::cloud
