// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/surface_distance.hpp"

#include <limits>

namespace biteline::sim {

namespace {

constexpr int k_coarse_places = 400;

}  // namespace

SurfaceDistance::SurfaceDistance(const MadeShoe& shoe) : shoe_(shoe) {
  for (int i = 0; i < k_coarse_places; ++i)
    coarse_.push_back(shoe.outline().at(shoe.perimeter_mm() * i / k_coarse_places).point);
}

double SurfaceDistance::place_of_mm(const Vec3& point_shoe) const {
  const Vec2 point = point_shoe.head<2>();
  double nearest_mm2 = std::numeric_limits<double>::max();
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < coarse_.size(); ++i) {
    const double distance_mm2 = (coarse_[i] - point).squaredNorm();
    if (distance_mm2 >= nearest_mm2) continue;
    nearest_mm2 = distance_mm2;
    nearest = i;
  }
  double s_mm = shoe_.perimeter_mm() * static_cast<double>(nearest) / k_coarse_places;
  // Newton on (point - C(s)) . T(s) = 0, whose derivative is -(1 + curvature * offset).
  for (int step = 0; step < 4; ++step) {
    const auto place = shoe_.outline().at(s_mm);
    const Vec2 away = point - place.point;
    s_mm += away.dot(place.tangent) / (1 + place.curvature_per_mm * away.dot(place.normal));
  }
  return s_mm;
}

double SurfaceDistance::signed_distance_mm(const Vec3& point_shoe) const {
  const double s_mm = place_of_mm(point_shoe);
  const Section section = shoe_.section(s_mm);
  const double offset_mm = (point_shoe.head<2>() - section.place().point).dot(section.place().normal);
  const Vec3 normal = shoe_.normal(s_mm, point_shoe.z());
  return (offset_mm - section.offset_mm(point_shoe.z())) * normal.head<2>().dot(section.place().normal);
}

}  // namespace biteline::sim
