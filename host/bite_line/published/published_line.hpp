// SPDX-License-Identifier: MIT
#pragma once
/// \file The line by the published method, to be compared with the product's own (bite_line).

#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/extraction.hpp"
#include "host/bite_line/line_stages.hpp"
#include "host/bite_line/published/steps.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::published {

/// What the steps handed on to each other: kept for pictures when asked for.
struct Workings {
  Config config;
  bite_line::Side side;
  Features features;
  std::vector<std::uint32_t> coarse_line;  ///< indices of the surface's points, along the line
  std::vector<Vec3> thinned_line;          ///< in shoe
  std::vector<float> path_row;             ///< per column of the features' picture; negative: none
};

/// Curvature, feature points, the eight-section picture, the traced line, back to 3-D, thinning, sequence.
/// The shoe and its side are found as the product finds them.  `points` in base, mm, finite.
[[nodiscard]] bite_line::Extraction find_bite_line(std::span<const Eigen::Vector3f> points,
                                                   const Config& config,
                                                   std::optional<Workings>* workings = nullptr);

/// What find_bite_line() did, and the feature points that the plain SVD would have found.
[[nodiscard]] bite_line::LineStages line_stages(const Workings& workings);

}  // namespace biteline::published
