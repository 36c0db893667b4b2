// SPDX-License-Identifier: MIT
#pragma once
/// \file One picture of one grid as the calibrations use it: where each ring's centre lies in the picture.

#include <string>
#include <vector>

#include "common/geometry/camera.hpp"
#include "host/calibration/rings/grid.hpp"

namespace biteline::calibration {

struct CentreObservation {
  Vec3 point_target{Vec3::Zero()};
  Vec2 pixel_px{Vec2::Zero()};
};

struct PlaneView {
  std::string name;  ///< the picture's, for words about it
  GridView grid;
  RingTarget target;
  std::vector<CentreObservation> centres;  ///< one per ring of `grid`, of its first reading
};

/// Centres from each ring's pair of ellipses: free of perspective bias with nothing known about the camera.
[[nodiscard]] PlaneView make_plane_view(std::string name, const GridView& grid, const RingTarget& target);

/// Centres again, now with camera and pose nearly known.  The edges are freed of the lens distortion, each
/// edge's ellipse gives a centre whose perspective bias follows from pose and diameter, and the mean of both
/// edges has less than half the pair's noise: the pair extrapolates from the outer to the inner centre by a
/// factor 4/3, this averages.  A chessboard's corners have no bias, and stay.
void improve_centres(PlaneView& view, const geometry::Camera& camera, const SE3& T_cam_target);

/// Takes out rings that lie much farther from where camera and pose put them than their view's others do:
/// damaged print, a shadow's or a glare's edge.  Measured by the spread within the view: in one that
/// disagrees as a whole nothing stands out.  How many.
int set_rings_aside(PlaneView& view, const geometry::Camera& camera, const SE3& T_cam_target);

/// Median over the rings of seen inner to outer diameter; far from the target's own: another print than
/// target.yaml says.
[[nodiscard]] double seen_diameter_ratio(const PlaneView& view);

}  // namespace biteline::calibration
