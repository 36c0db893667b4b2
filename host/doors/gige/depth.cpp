// SPDX-License-Identifier: MIT
#include "host/doors/gige/depth.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/numbers.hpp"

namespace biteline::gige {
namespace {

/// Some room at both ends, for calibrations that bend at the corners.
constexpr double k_room = 0.05;
/// A step is a whole multiple of this.
constexpr double k_step_mm = 0.0005;
constexpr double k_values = 65000;

}  // namespace

Depth depth_of(const geometry::SensorModel& model) {
  double nearest = k_far_mm, farthest = 0;
  for (const int u : {0, model.region.width_px - 1}) {
    for (const int v : {0, model.region.height_px - 1}) {
      const Vec2 pixel{model.region.offset_u_px + u, model.region.offset_v_px + v};
      const double z = geometry::triangulate(model.camera, model.laser_plane, pixel).z();
      if (!(z > 0 && z < k_far_mm)) return {};
      nearest = std::min(nearest, z);
      farthest = std::max(farthest, z);
    }
  }
  const double room = k_room * (farthest - nearest);
  const double offset = std::max(0.0, std::floor(nearest - room));
  const double steps = std::ceil((farthest + room - offset) / k_values / k_step_mm);
  return {.scale_mm = static_cast<float>(std::max(1.0, steps) * k_step_mm),
          .offset_mm = static_cast<float>(offset)};
}

}  // namespace biteline::gige
