// SPDX-License-Identifier: MIT
#pragma once
/// \file Pixel to point on the laser plane, from a table made once per head.

#include <optional>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/rt/annotations.hpp"

namespace biteline::pipeline {

/// Undistortion and plane intersection (method, stage 5: X = r d / (n . r)) in one look-up.  Per column and
/// grid row the point itself and its derivative by row are kept; between grid rows a cubic Hermite step,
/// whose error falls with the fourth power of the spacing (tests/unit/firmware/pipeline holds it to 0.1 um
/// over the whole region).
///
/// Single precision: a point at 400 mm has steps of 0.03 um.  Thread: immutable.  RT: rt_ members.
class TriangulationTable {
 public:
  /// Rays that miss the plane or meet it behind the camera have no value: a corner of a wide picture does so.
  /// Fails when no ray of the region has one.
  [[nodiscard]] static Result<TriangulationTable> create(const geometry::SensorModel& sensor);

  struct Point {
    Eigen::Vector3f point_cam;  ///< mm
    float mm_per_row;  ///< length moved along the plane per pixel of row: what sigma_row_px is multiplied by
  };

  /// `row_px` in the region, sub-pixel, clamped to it; NaN where there is no value.  Pre: 0 <= column <
  /// width.
  [[nodiscard]] Point rt_point(int column, float row_px) const noexcept BITELINE_RT;

 private:
  struct Node {
    Eigen::Vector3f point_cam;
    Eigen::Vector3f slope_mm;  ///< d point / d row, times the grid's spacing
  };
  static constexpr int k_rows_per_node = 8;
  static constexpr float k_rounding_mm = 2e-4F;  ///< single precision, up to 2 m away

  [[nodiscard]] static std::optional<Node> node_at(const geometry::SensorModel& sensor, const Vec2& pixel_px);

  int width_px_{0};
  int nodes_per_column_{0};
  std::vector<Node> nodes_;  ///< column-major: a column's nodes stand together
};

}  // namespace biteline::pipeline
