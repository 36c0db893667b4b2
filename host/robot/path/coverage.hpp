// SPDX-License-Identifier: MIT
#pragma once
/// \file What of a shoe a path's tool covers, before anything is sent.

#include <span>
#include <vector>

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

/// Across the way, at one waypoint of the line: on the surface, from edge to edge.
struct CoveredSection {
  double arc_mm{0};    ///< of the path
  double width_mm{0};  ///< along the surface; 0: the tool meets none of its points
};

struct CoveredSurface {
  std::vector<CoveredSection> sections{};
  std::vector<std::uint8_t> times{};  ///< of each point: how often the tool comes over it
};

/// A fan from the tip, as wide as the cone, or a contact that lies against the surface round the tip; square
/// to the tip's way, and on what of the surface it meets first.  `points` in the arm's base, mm.  A process
/// without a width covers nothing.
[[nodiscard]] CoveredSurface covered_surface(const PlannedPath& path, const Coverage& coverage,
                                             std::span<const Eigen::Vector3f> points);

}  // namespace biteline::path
