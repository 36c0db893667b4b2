// SPDX-License-Identifier: MIT
#include "firmware/pipeline/triangulation_table.hpp"

#include <limits>
#include <optional>

#include "common/core/numbers.hpp"

namespace biteline::pipeline {
namespace {

/// Of a row: less than the noise of the best peak (0.01 px).
constexpr double k_step_error_px = 0.005;

}  // namespace

std::optional<TriangulationTable::Node> TriangulationTable::node_at(const geometry::SensorModel& sensor,
                                                                    const Vec2& pixel_px) {
  constexpr double k_step_px = 0.01;  // central difference: error below 1e-9 mm
  const auto point_at = [&](double rows_px) -> std::optional<Vec3> {
    const Vec3 ray = sensor.camera.ray({pixel_px.x(), pixel_px.y() + rows_px});
    // z is d / (n . r): positive, and not where a ray nearly along the plane would meet it.
    const double towards = sensor.laser_plane.normal_cam.dot(ray);
    const double distance_mm = sensor.laser_plane.distance_mm;
    if (!(towards * distance_mm > 0) || std::abs(distance_mm) > k_far_mm * std::abs(towards))
      return std::nullopt;
    return ray * (distance_mm / towards);
  };
  const auto middle = point_at(0), before = point_at(-k_step_px), after = point_at(k_step_px);
  if (!middle || !before || !after) return std::nullopt;
  return Node{.point_cam = middle->cast<float>(),
              .slope_mm = ((*after - *before) * (k_rows_per_node / (2 * k_step_px))).cast<float>()};
}

Result<TriangulationTable> TriangulationTable::create(const geometry::SensorModel& sensor) {
  const geometry::Region& region = sensor.region;
  if (region.width_px < 1 || region.height_px < 1) {
    return fail(Errc::InvalidArgument, "region %d x %d px is empty", region.width_px, region.height_px);
  }
  const Node nothing{.point_cam = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()),
                     .slope_mm = Eigen::Vector3f::Zero()};
  TriangulationTable table;
  table.width_px_ = region.width_px;
  table.nodes_per_column_ = (region.height_px + k_rows_per_node - 1) / k_rows_per_node + 1;
  table.nodes_.reserve(static_cast<std::size_t>(table.width_px_) *
                       static_cast<std::size_t>(table.nodes_per_column_));
  bool any = false;
  for (int column = 0; column < region.width_px; ++column) {
    std::optional<Node> last;
    for (int node = 0; node < table.nodes_per_column_; ++node) {
      const auto pixel_at = [&](double rows) -> Vec2 {
        return {column + region.offset_u_px, rows * k_rows_per_node + region.offset_v_px};
      };
      std::optional<Node> here = node_at(sensor, pixel_at(node));
      // Towards the plane's horizon points run away faster than a cubic follows.
      if (here && last) {
        const Eigen::Vector3f chord = here->point_cam - last->point_cam;
        const Eigen::Vector3f stepped =
            last->point_cam + 0.5F * chord + 0.125F * (last->slope_mm - here->slope_mm);
        const std::optional<Node> direct = node_at(sensor, pixel_at(node - 0.5));
        const float allowed_mm =
            static_cast<float>(k_step_error_px / k_rows_per_node) * here->slope_mm.norm();
        if (!direct || !((stepped - direct->point_cam).norm() <= allowed_mm + k_rounding_mm)) {
          here = std::nullopt;
        } else {
          any = true;
        }
      }
      table.nodes_.push_back(here.value_or(nothing));
      last = here;
    }
  }
  if (!any) {
    return fail(Errc::BadValue,
                "laser plane: no ray of the region %d x %d at %d, %d meets it before the camera",
                region.width_px, region.height_px, region.offset_u_px, region.offset_v_px);
  }
  return table;
}

}  // namespace biteline::pipeline
