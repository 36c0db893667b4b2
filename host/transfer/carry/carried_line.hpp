// SPDX-License-Identifier: MIT
#pragma once
/// \file A sample's line carried onto another surface by rays.

#include <optional>
#include <vector>

#include "common/core/result.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/transfer/carry/ray.hpp"
#include "host/transfer/refused.hpp"

namespace biteline::transfer {

/// The sample's line where the alignment has put it: in the surface's frame, in order, closed.
struct PlacedPoint {
  Vec3 position{Vec3::Zero()};
  Vec3 normal{Vec3::UnitX()};  ///< outward, unit
  double confidence{1};
  double sigma_mm{0.1};     ///< how far the true line may be off here, across the line
  double sample_u95_mm{0};  ///< of the sample's own line here; 0: not known
  /// Along the ray to the sample's own wall above the line, where that is seen: gaps are bridged as it runs.
  std::optional<double> wall_mm{};
};

enum class RayDirection {
  Level,   ///< the horizontal part of the normal: the sole's edge keeps its height when it is pressed on
  Normal,  ///< the normal itself (the published method)
};

struct CarryOptions {
  RayDirection direction{RayDirection::Level};
  Vec3 up{Vec3::UnitZ()};   ///< the shoe's z in the surface's frame
  double reach_mm{15};      ///< a sample's groove and sole lie at most so far from the upper's wall
  double max_gap_mm{15};    ///< longest way along the line without a hit that is bridged
  double normal_low_mm{2};  ///< the normal is that of the surface between these heights above the line
  double normal_high_mm{6};
};

/// Outward, along which the placed point is looked for on the surface.
[[nodiscard]] Vec3 ray_direction(const PlacedPoint& point, const CarryOptions& options);

struct CarriedLine {
  cloud::ClosedLine line{};     ///< empty when refused
  std::vector<bool> bridged{};  ///< per point: over a gap, not on a hit
  std::size_t rays{0}, hits{0};
  double bridged_mm{0};  ///< length of all bridges
  double longest_gap_mm{0};
  double mean_distance_mm{0};        ///< from the sample's line to this one along the rays
  std::optional<Refusal> refusal{};  ///< why there is no line
};

/// Every placed point's ray meets the surface, and none something else.  Pre: at least 3 points.
[[nodiscard]] bool all_met(const RaySurface& surface, const std::vector<PlacedPoint>& placed,
                           const CarryOptions& options);

/// Evenly spaced as the placed line was, anticlockwise seen from `up`.  Pre: at least 3 points.
[[nodiscard]] CarriedLine carry_line(const RaySurface& surface, const std::vector<PlacedPoint>& placed,
                                     const CarryOptions& options);

}  // namespace biteline::transfer
