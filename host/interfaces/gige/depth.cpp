// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/depth.hpp"

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

struct Span {
  double low{k_far_mm}, high{-k_far_mm};

  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double low_with_room() const { return low - k_room * (high - low); }
  [[nodiscard]] double high_with_room() const { return high + k_room * (high - low); }
};

Scale scale_of(double low_mm, double high_mm) {
  const double offset = std::floor(low_mm);
  const double steps = std::ceil((high_mm - offset) / k_values / k_step_mm);
  return {.scale_mm = static_cast<float>(std::max(1.0, steps) * k_step_mm),
          .offset_mm = static_cast<float>(offset)};
}

}  // namespace

Depth depth_of(const geometry::SensorModel& model) {
  Span depths, across;
  for (const int u : {0, model.region.width_px - 1}) {
    for (const int v : {0, model.region.height_px - 1}) {
      const Vec2 pixel{model.region.offset_u_px + u, model.region.offset_v_px + v};
      const Vec3 point = geometry::triangulate(model.camera, model.laser_plane, pixel);
      if (!(point.z() > 0 && point.z() < k_far_mm) || !(std::abs(point.x()) < k_far_mm)) return {};
      depths.take(point.z());
      across.take(point.x());
    }
  }
  const Scale z = scale_of(std::max(0.0, depths.low_with_room()), depths.high_with_room());
  return {.scale_mm = z.scale_mm,
          .offset_mm = z.offset_mm,
          .across = scale_of(across.low_with_room(), across.high_with_room())};
}

}  // namespace biteline::gige
