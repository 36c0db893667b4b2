// SPDX-License-Identifier: MIT
#pragma once
/// \file The published line in the unrolled picture: greedy growth, forks, joining, closure.

#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/published/unrolled.hpp"
#include "host/bite_line/refused.hpp"

namespace biteline::published {

struct TraceConfig {
  float strong_per_mm{0.06F};   ///< mean curvature below minus this is a feature
  int last_points{8};           ///< K: of the growing segment, for its direction
  double rectangle_px{9.0};     ///< length of the search rectangle; its width is a third (3 : 1)
  double fork_ratio{0.7};       ///< epsilon: main eigenvalue over the sum, below it is a fork
  int shortest_px{8};           ///< shorter segments are dropped before joining
  double longest_gap_px{40.0};  ///< between the ends of two segments that are joined
  double join_cosine{0.85};     ///< of the main directions of two segments that are joined
  double whole_ratio{0.95};     ///< the joined line must span this share of the picture's width
  double closure_mm{3.0};       ///< h on the left equals h' on the right within this
};

using Segment = std::vector<Vec2>;  ///< (column, row) in pixels, left to right

[[nodiscard]] std::vector<Segment> trace_segments(const Unrolled& picture, const TraceConfig& config);

struct TracedLine {
  std::optional<bite_line::Refusal> refusal;  ///< when it does not close
  std::vector<float> path_row;  ///< per column; negative outside the joined line; straight between segments
  double closure_mm{0};
  double covered_ratio{0};  ///< share of the columns with a traced pixel
};

/// Joins left to right into the longest line and checks that it closes.
[[nodiscard]] TracedLine join_segments(const Unrolled& picture, const std::vector<Segment>& segments,
                                       const TraceConfig& config);

}  // namespace biteline::published
