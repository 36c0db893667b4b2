// SPDX-License-Identifier: MIT
#include "hal/sim/record/calibration_views.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace biteline::sim {
namespace {

constexpr double k_ring_margin_px = 15;
/// Draws of a view before the next smaller tilt is tried.
constexpr int k_most_draws = 2000;
/// Half of the gap between the two sheets of the laser target's edge.
constexpr double k_ridge_gap_mm = 1.2;

}  // namespace

RingGrid plane_grid() {
  return {.rows = 4, .cols = 3};
}

std::string grid_text(const RingGrid& grid) {
  char text[200];
  if (grid.chessboard) {
    std::snprintf(text, sizeof text, "kind: chessboard\nsquare_rows: %d\nsquare_cols: %d\npitch: %.1f\n",
                  grid.rows + 1, grid.cols + 1, grid.pitch_mm);
    return text;
  }
  std::snprintf(text, sizeof text,
                "rows: %d\ncols: %d\npitch: %.1f\nouter_diameter: %.1f\ninner_diameter: %.1f\n", grid.rows,
                grid.cols, grid.pitch_mm, grid.outer_diameter_mm, grid.inner_diameter_mm);
  return text;
}

SurfaceMesh mesh_of_sheets(std::span<const PlacedGrid> sheets) {
  SurfaceMesh mesh;
  for (const auto& sheet : sheets) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const double x = sheet.grid.width_mm() / 2, y = sheet.grid.height_mm() / 2;
    for (const Vec3& corner : {Vec3(-x, -y, 0), Vec3(x, -y, 0), Vec3(x, y, 0), Vec3(-x, y, 0)}) {
      const Eigen::Vector3f p = (sheet.T_cam_sheet * corner).cast<float>();
      mesh.vertices.push_back({p.x(), p.y(), p.z()});
      mesh.looks.push_back({.diffuse_ratio = 0.8, .glossy = false});
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

PlacedGrid CalibrationViews::draw_view(double tilt_rad) {
  for (;; tilt_rad *= 0.9) {
    for (int draw = 0; draw < k_most_draws; ++draw) {
      const double direction_rad = random_.uniform({0, 2 * std::numbers::pi}),
                   tilt = tilt_rad * std::sqrt(random_.uniform({0.1, 1}));
      const Mat3 R = geometry::exp_so3(Vec3(0, 0, random_.uniform({-0.5, 0.5}))) *
                     geometry::exp_so3(tilt * Vec3(std::cos(direction_rad), std::sin(direction_rad), 0));
      const Vec3 place(random_.uniform({-25, 25}), random_.uniform({-22, 22}), random_.uniform({190, 270}));
      PlacedGrid view{.grid = {}, .T_cam_sheet = geometry::make_se3(Eigen::Quaterniond(R), place)};
      if (!all_rings_visible(head_, view, k_ring_margin_px)) continue;
      if (squares_ > 0) view.grid = view.grid.as_chessboard(squares_);
      return view;
    }
  }
}

std::array<PlacedGrid, 2> CalibrationViews::draw_two_planes(double plane_angle_rad) {
  const RingGrid grid = squares_ > 0 ? plane_grid().as_chessboard(squares_) : plane_grid();
  for (;;) {
    const Mat3 R = geometry::exp_so3(Vec3(0, 0, random_.uniform({-0.25, 0.25}))) *
                   geometry::exp_so3(Vec3(random_.uniform({-0.2, 0.2}), random_.uniform({-0.2, 0.2}), 0));
    const SE3 T_cam_ridge = geometry::make_se3(
        Eigen::Quaterniond(R),
        {random_.uniform({-10, 10}), random_.uniform({-8, 8}), random_.uniform({165, 205})});
    std::array<PlacedGrid, 2> sheets;
    for (int side = 0; side < 2; ++side) {
      const double sign = side == 0 ? -1 : 1;
      const double turn_rad = sign * (std::numbers::pi - plane_angle_rad) / 2;
      SE3 T_ridge_sheet = SE3::Identity();
      T_ridge_sheet.linear() = geometry::exp_so3(Vec3(0, -turn_rad, 0));
      T_ridge_sheet.translation() =
          T_ridge_sheet.linear() * Vec3(sign * (grid.width_mm() / 2 + k_ridge_gap_mm), 0, 0);
      sheets[static_cast<std::size_t>(side)] = {.grid = grid, .T_cam_sheet = T_cam_ridge * T_ridge_sheet};
    }
    if (all_rings_visible(head_, sheets[0], k_ring_margin_px) &&
        all_rings_visible(head_, sheets[1], k_ring_margin_px))
      return sheets;
  }
}

LampLight CalibrationViews::draw_lamp(double scaled_ratio) {
  return {.white_grey = random_.uniform({170, 225}),
          .slope_ratio = random_.uniform({0.1, 0.5}),
          .slope_rad = random_.uniform({-3, 3}),
          .scaled_ratio = scaled_ratio};
}

SE3 CalibrationViews::draw_table_place() {
  return geometry::make_se3(
      Eigen::Quaterniond(geometry::exp_so3(Vec3(0, 0, random_.uniform({-0.3, 0.3}))) *
                         geometry::exp_so3(Vec3(std::numbers::pi, 0, 0))),
      {random_.uniform({400, 480}), random_.uniform({-60, 60}), random_.uniform({0, 40})});
}

}  // namespace biteline::sim
