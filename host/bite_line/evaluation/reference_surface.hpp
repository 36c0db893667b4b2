// SPDX-License-Identifier: MIT
#pragma once
/// \file A triangle mesh taken as truth: nearest points, signed distances, rays.

#include <memory>
#include <optional>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "host/cloud/ply.hpp"

namespace biteline::evaluation {

/// Embree finds the triangles; distances are then computed in double precision from the mesh itself.
/// Thread: const members may be called from many threads at once.
class ReferenceSurface {
 public:
  struct Nearest {
    Vec3 point;                 ///< on the surface
    Vec3 normal;                ///< of its triangle, outward
    double signed_distance_mm;  ///< > 0 outside
  };
  struct Hit {
    Vec3 point;
    Vec3 normal;  ///< of the triangle, as its corners turn
  };
  struct Ray {
    Vec3 origin;
    Vec3 direction;  ///< unit
    double length_mm{0};
  };

  /// Pre: at least one triangle, indices in range.
  explicit ReferenceSurface(const cloud::TriangleMesh& mesh);
  ReferenceSurface(ReferenceSurface&&) noexcept;
  ReferenceSurface& operator=(ReferenceSurface&&) noexcept;
  ~ReferenceSurface();

  /// Nothing when no triangle is within `reach_mm`.
  ///
  /// Where several triangles share the nearest point (an edge, a corner), the sign follows the one that
  /// `point` lies most squarely before or behind; the others' planes may pass on its wrong side.
  [[nodiscard]] std::optional<Nearest> nearest(const Vec3& point, double reach_mm) const;

  [[nodiscard]] std::optional<Hit> first_hit(const Ray& ray) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace biteline::evaluation
