// SPDX-License-Identifier: MIT
#pragma once
/// \file Where ring targets stand before a made head when it is calibrated.

#include <array>
#include <span>
#include <string>

#include "hal/sim/record/ring_target.hpp"
#include "hal/sim/shoe/random.hpp"
#include "hal/sim/shoe/surface_mesh.hpp"

namespace biteline::sim {

/// Of each of the two planes of the laser's target.
[[nodiscard]] RingGrid plane_grid();
/// target.yaml of one grid.
[[nodiscard]] std::string grid_text(const RingGrid& grid);
/// In the camera's frame, white.
[[nodiscard]] SurfaceMesh mesh_of_sheets(std::span<const PlacedGrid> sheets);

/// Draws places until every ring lies in the picture.
class CalibrationViews {
 public:
  /// Single sheets stand in the same places whatever `squares` says; the two of the laser lie farther
  /// apart, since squares reach farther than rings.
  CalibrationViews(const MadeHead& head, const Random& random, int squares = 0)
      : head_{head}, random_{random}, squares_{squares} {}

  /// A sheet somewhere in the field, tilted up to `tilt_rad`.
  [[nodiscard]] PlacedGrid draw_view(double tilt_rad);
  /// The two sheets meet in an upright ridge towards the camera, each turned away by half their angle.
  [[nodiscard]] std::array<PlacedGrid, 2> draw_two_planes(double plane_angle_rad);
  [[nodiscard]] LampLight draw_lamp(double scaled_ratio);
  /// The sheet lies on the table, its z down, so that the camera looks along it.
  [[nodiscard]] SE3 draw_table_place();
  [[nodiscard]] double gaussian() { return random_.gaussian(); }

 private:
  MadeHead head_;
  Random random_;
  int squares_;  ///< 0: rings
};

}  // namespace biteline::sim
