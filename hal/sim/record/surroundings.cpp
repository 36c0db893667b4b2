// SPDX-License-Identifier: MIT
#include "hal/sim/record/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace biteline::sim {

namespace {

constexpr SurfaceLook k_steel{.diffuse_ratio = 0.25}, k_wood{.diffuse_ratio = 0.5};

std::uint32_t add_corner(SurfaceMesh& mesh, const Vec3& corner, SurfaceLook look) {
  mesh.vertices.push_back(
      {static_cast<float>(corner.x()), static_cast<float>(corner.y()), static_cast<float>(corner.z())});
  mesh.looks.push_back(look);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

void add_face(SurfaceMesh& mesh, const std::array<Vec3, 4>& corners, SurfaceLook look) {
  std::array<std::uint32_t, 4> at{};
  for (std::size_t i = 0; i < 4; ++i) at[i] = add_corner(mesh, corners[i], look);
  mesh.triangles.push_back({at[0], at[1], at[2]});
  mesh.triangles.push_back({at[0], at[2], at[3]});
}

/// An upright prism over a polygon that runs anticlockwise: its sides and its top.
void add_prism(SurfaceMesh& mesh, const std::vector<Vec2>& polygon, double bottom_mm, double top_mm,
               SurfaceLook look) {
  Vec2 middle = Vec2::Zero();
  for (const Vec2& corner : polygon) middle += corner / static_cast<double>(polygon.size());
  const std::uint32_t centre = add_corner(mesh, {middle.x(), middle.y(), top_mm}, look);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const Vec3 a_top(a.x(), a.y(), top_mm), b_top(b.x(), b.y(), top_mm);
    add_face(mesh, {Vec3(a.x(), a.y(), bottom_mm), Vec3(b.x(), b.y(), bottom_mm), b_top, a_top}, look);
    mesh.triangles.push_back({centre, add_corner(mesh, a_top, look), add_corner(mesh, b_top, look)});
  }
}

std::vector<Vec2> circle(const Vec2& middle, double radius_mm) {
  constexpr int k_sides = 16;
  std::vector<Vec2> corners;
  for (int i = 0; i < k_sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / k_sides;
    corners.emplace_back(middle + radius_mm * Vec2(std::cos(angle), std::sin(angle)));
  }
  return corners;
}

std::vector<Vec2> box(const Vec2& low, const Vec2& high) {
  return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

constexpr double k_every_mm = 5;

}  // namespace

std::vector<Vec2> plate_outline(const Outline& outline) {
  std::vector<Vec2> corners;
  for (double s_mm = 0; s_mm < outline.perimeter_mm(); s_mm += k_every_mm) {
    const Outline::Place place = outline.at(s_mm);
    corners.emplace_back(place.point + k_plate_beyond_mm * place.normal);
  }
  return corners;
}

double plate_beyond_line_mm(const Outline& outline, const std::vector<TrueLinePoint>& line) {
  if (line.empty()) return k_plate_beyond_mm;
  double farthest_mm = 0;
  for (const Vec2& corner : plate_outline(outline)) {
    double to_line_mm = std::numeric_limits<double>::infinity();
    for (const TrueLinePoint& point : line)
      to_line_mm = std::min(to_line_mm, (point.point_shoe.head<2>() - corner).norm());
    farthest_mm = std::max(farthest_mm, to_line_mm);
  }
  return farthest_mm;
}

void add_surroundings(SurfaceMesh& mesh, const Outline& outline) {
  constexpr double k_table_half_mm = 800;
  constexpr int k_pins = 6;
  Vec2 low = outline.at(0).point, high = low;
  for (double s_mm = 0; s_mm < outline.perimeter_mm(); s_mm += k_every_mm) {
    low = low.cwiseMin(outline.at(s_mm).point);
    high = high.cwiseMax(outline.at(s_mm).point);
  }
  const Vec2 middle = 0.5 * (low + high);
  const Vec2 reach = Vec2::Constant(k_table_half_mm);
  add_prism(mesh, box(middle - reach, middle + reach), -2 * k_fixture_plate_mm, -k_fixture_plate_mm, k_wood);
  add_prism(mesh, plate_outline(outline), -k_fixture_plate_mm, 0, k_steel);
  for (int i = 0; i < k_pins; ++i) {
    const Outline::Place foot = outline.at((i + 0.5) / k_pins * outline.perimeter_mm());
    add_prism(mesh, circle(foot.point + k_pin_gap_mm * foot.normal, k_pin_radius_mm), 0, k_pin_height_mm,
              k_steel);
  }
}

}  // namespace biteline::sim
