// SPDX-License-Identifier: MIT
#pragma once
/// \file How far a measured point lies from a made shoe's exact wall.

#include <vector>

#include "hal/sim/shoe/made_shoe.hpp"

namespace biteline::sim {

/// Thread: any.  Cost: some 20 microseconds a point.  Refers to its shoe: lives no longer.
class SurfaceDistance {
 public:
  explicit SurfaceDistance(const MadeShoe& shoe);

  /// Along the wall's outward normal, first order: exact for points closer than a tenth of the surface's
  /// radius of curvature there.  Pre: 0 <= z <= top.
  [[nodiscard]] double signed_distance_mm(const Vec3& point_shoe) const;

  /// The outline place whose normal passes through the point.
  [[nodiscard]] double place_of_mm(const Vec3& point_shoe) const;

 private:
  const MadeShoe& shoe_;
  std::vector<Vec2> coarse_;
};

}  // namespace biteline::sim
