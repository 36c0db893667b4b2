// SPDX-License-Identifier: MIT
#include "firmware/pipeline/triangulation_table.hpp"

namespace biteline::pipeline {

Result<TriangulationTable> TriangulationTable::create(const geometry::SensorModel& sensor) {
  const geometry::Region& region = sensor.region;
  if (region.width_px < 1 || region.height_px < 1) {
    return fail(Errc::InvalidArgument, "region %d x %d px is empty", region.width_px, region.height_px);
  }
  TriangulationTable table;
  table.width_px_ = region.width_px;
  table.nodes_per_column_ = (region.height_px + k_rows_per_node - 1) / k_rows_per_node + 1;
  table.nodes_.reserve(static_cast<std::size_t>(table.width_px_) *
                       static_cast<std::size_t>(table.nodes_per_column_));
  for (int column = 0; column < region.width_px; ++column) {
    for (int node = 0; node < table.nodes_per_column_; ++node) {
      const auto point_at = [&](double row_px) {
        return geometry::triangulate(sensor.camera, sensor.laser_plane,
                                     {column + region.offset_u_px, row_px + region.offset_v_px});
      };
      const double row_px = node * k_rows_per_node;
      constexpr double k_step_px = 0.01;  // central difference: error below 1e-9 mm
      const Vec3 point_cam = point_at(row_px);
      const Vec3 slope_mm =
          (point_at(row_px + k_step_px) - point_at(row_px - k_step_px)) * (k_rows_per_node / (2 * k_step_px));
      if (!(point_cam.z() > 0) || !point_cam.allFinite()) {
        return fail(Errc::BadValue, "laser plane: no intersection with the ray of column %d, row %g", column,
                    row_px);
      }
      table.nodes_.push_back({.point_cam = point_cam.cast<float>(), .slope_mm = slope_mm.cast<float>()});
    }
  }
  return table;
}

}  // namespace biteline::pipeline
