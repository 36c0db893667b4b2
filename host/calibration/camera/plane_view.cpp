// SPDX-License-Identifier: MIT
#include "host/calibration/camera/plane_view.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "host/geometry/robust.hpp"

namespace biteline::calibration {

namespace {

/// A ring farther than this many standard deviations is not seen as it is; below the floor, what is odd about
/// it is noise.
constexpr double k_ring_outlier_sigmas = 6, k_ring_outlier_floor_px = 0.03;

/// Centre of one edge, in ideal coordinates, less the bias that a circle of this radius has under this pose.
std::optional<Vec2> unbiased_centre(std::span<const Vec2> edge_px, const geometry::Camera& camera,
                                    const Mat3& H_ideal_target, const Vec3& ring_target, double radius_mm) {
  std::vector<Vec2> ideal;
  ideal.reserve(edge_px.size());
  for (const Vec2& pixel_px : edge_px) ideal.emplace_back(camera.ray(pixel_px).head<2>());
  const std::optional<Ellipse> seen = fit_ellipse(ideal);
  const std::optional<Ellipse> expected = project_circle(H_ideal_target, ring_target.head<2>(), radius_mm);
  if (!seen || !expected) return std::nullopt;
  const Vec3 centre = H_ideal_target * Vec3(ring_target.x(), ring_target.y(), 1);
  return seen->centre - (expected->centre - centre.head<2>() / centre.z());
}

}  // namespace

PlaneView make_plane_view(std::string name, const GridView& grid, const RingTarget& target) {
  PlaneView view{.name = std::move(name), .grid = grid, .target = target, .centres = {}};
  for (const GridRing& ring : grid.rings) {
    view.centres.push_back(
        {.point_target = target.ring_target(ring.row, ring.col), .pixel_px = ring.ring.centre_px});
  }
  return view;
}

void improve_centres(PlaneView& view, const geometry::Camera& camera, const SE3& T_cam_target) {
  if (view.target.chessboard()) return;  // its corners are where they are seen
  Mat3 H_ideal_target;
  H_ideal_target << T_cam_target.linear().col(0), T_cam_target.linear().col(1), T_cam_target.translation();
  for (std::size_t i = 0; i < view.centres.size(); ++i) {
    const Ring& ring = view.grid.rings[i].ring;
    const Vec3& place = view.centres[i].point_target;
    const auto outer =
        unbiased_centre(ring.outer_edge, camera, H_ideal_target, place, view.target.outer_diameter_mm / 2);
    const auto inner =
        unbiased_centre(ring.inner_edge, camera, H_ideal_target, place, view.target.inner_diameter_mm / 2);
    if (!outer || !inner) continue;
    // Noise of a centre falls with the number of edge points.
    const double w_outer = static_cast<double>(ring.outer_edge.size()),
                 w_inner = static_cast<double>(ring.inner_edge.size());
    const Vec2 ideal = (w_outer * *outer + w_inner * *inner) / (w_outer + w_inner);
    view.centres[i].pixel_px = camera.project(Vec3(ideal.x(), ideal.y(), 1));
  }
}

int set_rings_aside(PlaneView& view, const geometry::Camera& camera, const SE3& T_cam_target) {
  std::vector<double> distances_px;
  for (const CentreObservation& c : view.centres)
    distances_px.push_back((camera.project(T_cam_target * c.point_target) - c.pixel_px).norm());
  std::vector<double> sorted = distances_px;
  std::sort(sorted.begin(), sorted.end());
  // 1.1774: median distance of a two-dimensional normal law to its standard deviation per coordinate.
  const double limit_px =
      std::max(k_ring_outlier_floor_px, k_ring_outlier_sigmas * sorted[sorted.size() / 2] / 1.1774);
  int count = 0;
  for (std::size_t i = view.centres.size(); i-- > 0;) {
    if (distances_px[i] < limit_px || view.centres.size() <= static_cast<std::size_t>(k_least_grid_rings))
      continue;
    view.centres.erase(view.centres.begin() + static_cast<std::ptrdiff_t>(i));
    view.grid.rings.erase(view.grid.rings.begin() + static_cast<std::ptrdiff_t>(i));
    ++count;
  }
  return count;
}

double seen_diameter_ratio(const PlaneView& view) {
  std::vector<double> ratios;
  for (const GridRing& ring : view.grid.rings) ratios.push_back(ring.ring.diameter_ratio);
  return geometry::median_of(std::move(ratios));
}

}  // namespace biteline::calibration
