// SPDX-License-Identifier: MIT
#include "host/calibration/head/comparison.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::calibration {

Comparison compare_heads(const HeadFit& now, const geometry::SensorModel& before, int width_px) {
  constexpr int k_columns = 9;
  constexpr double k_rows_px = 150;
  Comparison result;
  const double middle_row_px = now.state.camera.project(now.plane_middle_cam).y();
  double square_sum = 0, count = 0;
  for (int i = 0; i < k_columns; ++i) {
    for (const double row_px : {middle_row_px - k_rows_px, middle_row_px, middle_row_px + k_rows_px}) {
      const Vec2 pixel_px((i + 0.5) * width_px / k_columns, row_px);
      const Vec3 was =
          before.T_flange_cam * geometry::triangulate(before.camera, before.laser_plane, pixel_px);
      const Vec3 is =
          now.state.T_flange_cam * geometry::triangulate(now.state.camera, now.state.plane, pixel_px);
      result.shift_flange_mm += is - was;
      square_sum += (is - was).squaredNorm();
      result.largest_mm = std::max(result.largest_mm, (is - was).norm());
      count += 1;
    }
  }
  result.shift_flange_mm /= count;
  result.rms_mm = std::sqrt(square_sum / count);
  result.turn_rad =
      geometry::angle_between_rad(before.T_flange_cam.linear(), now.state.T_flange_cam.linear());
  // The point in the flange: its place in cam, and the mounting's shift and turn on the way.
  const Vec3 point_sigma_mm = now.triangulation_sigma_mm(Vec2(width_px / 2.0, middle_row_px));
  const Twist mounting = now.mounting_sigma();
  const double lever_mm = now.plane_middle_cam.norm();
  result.sigma_mm = std::sqrt(point_sigma_mm.squaredNorm() + mounting.head<3>().squaredNorm() +
                              lever_mm * lever_mm * mounting.tail<3>().squaredNorm());
  result.moved = result.rms_mm > 3 * std::sqrt(2.0) * result.sigma_mm;
  return result;
}

}  // namespace biteline::calibration
