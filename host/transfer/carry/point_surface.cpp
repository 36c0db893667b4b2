// SPDX-License-Identifier: MIT
#include "host/transfer/carry/point_surface.hpp"

#include <tbb/parallel_sort.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "host/transfer/align/voxel_map.hpp"

namespace biteline::transfer {
namespace {

// Two spacings of the coarser scan direction (1 mm), so that a plane always sees two profiles.
constexpr double k_radius_mm = 1.8;
constexpr float k_voxel_mm = 1.8F;
constexpr std::size_t k_min_points = 8;
// Points on one side only: their mean is 4 r / (3 pi) = 0.42 r away.
constexpr double k_max_offset_ratio = 0.35;
constexpr double k_step_mm = 0.9;  // half a radius: no place is passed unseen
constexpr double k_settled_mm = 1e-3;
constexpr int k_max_rounds = 8;

}  // namespace

PointSurface::PointSurface(std::span<const Eigen::Vector3f> points) {
  const VoxelGrid grid{k_voxel_mm};
  struct Keyed {
    VoxelKey key;
    std::uint32_t point;
  };
  std::vector<Keyed> keyed(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) keyed[i] = {.key = grid.key(points[i]), .point = i};
  tbb::parallel_sort(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
    return a.key != b.key ? a.key < b.key : a.point < b.point;
  });
  points_.reserve(points.size());
  for (const Keyed& entry : keyed) {
    if (keys_.empty() || keys_.back() != entry.key) {
      keys_.push_back(entry.key);
      begins_.push_back(static_cast<std::uint32_t>(points_.size()));
    }
    points_.push_back(points[entry.point]);
  }
  begins_.push_back(static_cast<std::uint32_t>(points_.size()));
}

/// Calls visit(point, squared distance) for every point within the radius.
template <class Visit>
void PointSurface::visit_near(const Vec3& place, Visit&& visit) const {
  const VoxelKey centre = VoxelGrid{k_voxel_mm}.key(place.cast<float>());
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      // Three neighbours along x have consecutive keys.
      const VoxelKey first = VoxelGrid::neighbour(centre, -1, dy, dz);
      for (auto at = std::lower_bound(keys_.begin(), keys_.end(), first);
           at != keys_.end() && *at <= first + 2; ++at) {
        const auto voxel = static_cast<std::size_t>(at - keys_.begin());
        for (std::uint32_t i = begins_[voxel]; i < begins_[voxel + 1]; ++i) {
          const Vec3 p = points_[i].cast<double>();
          const double squared = (p - place).squaredNorm();
          if (squared < k_radius_mm * k_radius_mm) visit(p, squared);
        }
      }
    }
  }
}

bool PointSurface::anything_near(const Vec3& place) const {
  std::size_t count = 0;
  visit_near(place, [&](const Vec3&, double) { ++count; });
  return count >= k_min_points;
}

std::optional<PointSurface::Plane> PointSurface::plane_at(const Vec3& place) const {
  double total = 0;
  std::size_t count = 0;
  Vec3 sum = Vec3::Zero();
  Mat3 outer = Mat3::Zero();
  visit_near(place, [&](const Vec3& p, double squared) {
    const Vec3 d = p - place;
    const double ratio = squared / (k_radius_mm * k_radius_mm);
    const double weight = (1 - ratio) * (1 - ratio);
    total += weight;
    sum += weight * d;
    outer += weight * d * d.transpose();
    ++count;
  });
  if (count < k_min_points || total <= 0) return std::nullopt;
  const Vec3 mean = sum / total;
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(outer / total - mean * mean.transpose());
  const Vec3 normal = solver.eigenvectors().col(0).normalized();
  const Vec3 aside = mean - mean.dot(normal) * normal;
  if (aside.norm() > k_max_offset_ratio * k_radius_mm) return std::nullopt;
  return Plane{.point = place + mean, .normal = normal};
}

/// From `start_mm` to where the plane around the place passes through the place.
std::optional<Hit> PointSurface::settle(const Ray& ray, double start_mm) const {
  double at_mm = start_mm;
  for (int round = 0; round < k_max_rounds; ++round) {
    const std::optional<Plane> plane = plane_at(ray.origin + at_mm * ray.direction);
    if (!plane) return std::nullopt;
    const double cosine = plane->normal.dot(ray.direction);
    if (std::abs(cosine) < k_min_facing_cosine) return std::nullopt;
    const double next_mm = (plane->point - ray.origin).dot(plane->normal) / cosine;
    if (std::abs(next_mm - start_mm) > 2 * k_radius_mm) return std::nullopt;
    const bool settled = std::abs(next_mm - at_mm) < k_settled_mm;
    at_mm = next_mm;
    if (!settled) continue;
    // Scattered points do not tell outside from inside: a wall is taken to look the way the ray goes outward.
    return Hit{.distance_mm = at_mm,
               .position = ray.origin + at_mm * ray.direction,
               .normal = cosine > 0 ? plane->normal : Vec3{-plane->normal}};
  }
  return std::nullopt;
}

std::optional<Hit> PointSurface::cast(const Ray& ray) const {
  std::optional<Hit> best;
  for (double away_mm = 0; away_mm <= ray.reach_mm; away_mm += k_step_mm) {
    for (const double at_mm : {away_mm, -away_mm}) {
      if (!anything_near(ray.origin + at_mm * ray.direction)) continue;
      const std::optional<Hit> hit = settle(ray, at_mm);
      if (!hit || std::abs(hit->distance_mm) > ray.reach_mm) continue;
      if (!best || std::abs(hit->distance_mm) < std::abs(best->distance_mm)) best = hit;
    }
    // A later start settles at most a radius nearer than itself.
    if (best && away_mm > std::abs(best->distance_mm) + k_radius_mm) break;
  }
  return best;
}

}  // namespace biteline::transfer
