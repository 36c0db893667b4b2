// SPDX-License-Identifier: MIT
#pragma once
/// \file A surface given by scattered points only.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "host/transfer/carry/ray.hpp"

namespace biteline::transfer {

/// Moving least squares along the ray (Levin 1998; Adamson, Alexa 2003, "Ray tracing point set surfaces"):
/// where points lie near the ray, a plane is fitted to those around the place, weighted by distance; the
/// ray's crossing with it is the next place, until both agree.  Nothing is triangulated, so there is nothing
/// to bridge: at a hole or an edge the points lie to one side only, and there is no hit. Thread: immutable
/// after construction.  Memory: a copy of the points.
class PointSurface : public RaySurface {
 public:
  explicit PointSurface(std::span<const Eigen::Vector3f> points);

  [[nodiscard]] std::optional<Hit> cast(const Ray& ray) const override;

 private:
  struct Plane {
    Vec3 point, normal;
  };
  template <class Visit>
  void visit_near(const Vec3& place, Visit&& visit) const;
  [[nodiscard]] std::optional<Plane> plane_at(const Vec3& place) const;
  [[nodiscard]] bool anything_near(const Vec3& place) const;
  [[nodiscard]] std::optional<Hit> settle(const Ray& ray, double start_mm) const;

  std::vector<Eigen::Vector3f> points_;  ///< sorted by voxel
  std::vector<std::uint64_t> keys_;      ///< of the occupied voxels, rising
  std::vector<std::uint32_t> begins_;    ///< first point of each, and the end
};

}  // namespace biteline::transfer
