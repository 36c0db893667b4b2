// SPDX-License-Identifier: MIT
#pragma once
/// \file Back to 3-D, thinning and the sequence in the published order.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/se3.hpp"
#include "host/bite_line/published/unrolled.hpp"

namespace biteline::published {

/// Points around the 2-D line, ordered along it: the thick 3-D point set.  `candidates` are indices of
/// feature points.
[[nodiscard]] std::vector<std::uint32_t> back_project(std::span<const Eigen::Vector3f> points,
                                                      std::span<const std::uint32_t> candidates,
                                                      const Unrolled& picture, const EightSections& sections,
                                                      std::span<const float> path_row, double reach_mm);

struct ThinConfig {
  int lambda{10};  ///< points before and after, for the line through each
  int rounds{2};
};

/// Moves each point to its foot on the 3-D line through its neighbours (by principal direction: unlike the
/// published x = m z + x0, y = n z + y0 it holds for level lines).  `points` closed and in order.
[[nodiscard]] std::vector<Vec3> thin(std::vector<Vec3> points, const ThinConfig& config);

/// `count` points evenly spaced along a closed sequence of noisy ones: means over equal stretches of the
/// order.
[[nodiscard]] std::vector<Vec3> even_sequence(const std::vector<Vec3>& points, double spacing_mm);

}  // namespace biteline::published
