// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/fixture.hpp"

#include <algorithm>

namespace biteline::path {
namespace {

/// Even-odd rule.
bool within(const std::vector<Vec2>& outline, const Vec2& place) {
  bool in = false;
  for (std::size_t i = 0, k = outline.size() - 1; i < outline.size(); k = i++) {
    const Vec2 &a = outline[i], &b = outline[k];
    if ((a.y() > place.y()) != (b.y() > place.y()) &&
        place.x() < (b.x() - a.x()) * (place.y() - a.y()) / (b.y() - a.y()) + a.x())
      in = !in;
  }
  return in;
}

}  // namespace

void add_fixture(Surroundings& surroundings, const cloud::ClosedLine& line_base, const Fixture& fixture) {
  if (!(fixture.top_z_mm > surroundings.table_z_mm)) return;
  const double spacing_mm = surroundings.shoe_spacing_mm;
  // No arm here reaches farther down.
  constexpr double k_most_down_mm = 2000;
  const double foot_mm = std::max(surroundings.table_z_mm, fixture.top_z_mm - k_most_down_mm);
  FixtureBlock block{.top_z_mm = fixture.top_z_mm, .outline = {}};
  for (const cloud::LinePoint& p : line_base.points) {
    const Vec3 outwards = Vec3{p.normal.x(), p.normal.y(), 0}.normalized();
    const Vec3 edge = p.position + fixture.beyond_mm * outwards;
    const Vec2 corner = edge.head<2>();
    if (!block.outline.empty() && (corner - block.outline.back()).norm() < 0.5 * spacing_mm) continue;
    block.outline.push_back(corner);
    for (double out_mm = 0; out_mm < fixture.beyond_mm; out_mm += spacing_mm) {
      const Vec3 rim = p.position + out_mm * outwards;
      surroundings.shoe_points.emplace_back(rim.x(), rim.y(), fixture.top_z_mm);
    }
    for (double z_mm = fixture.top_z_mm; z_mm > foot_mm; z_mm -= spacing_mm)
      surroundings.shoe_points.emplace_back(edge.x(), edge.y(), z_mm);
  }
  surroundings.fixture = std::move(block);
}

double floor_mm(const Surroundings& surroundings, const Vec3& tip_base) {
  const std::optional<FixtureBlock>& block = surroundings.fixture;
  return block && within(block->outline, tip_base.head<2>())
             ? std::max(block->top_z_mm, surroundings.table_z_mm)
             : surroundings.table_z_mm;
}

}  // namespace biteline::path
