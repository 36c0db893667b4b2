// SPDX-License-Identifier: MIT
#pragma once
/// \file A surface that rays can be shot at: the one place where Embree is met.

#include <cstdint>
#include <memory>
#include <optional>

#include "common/core/result.hpp"
#include "hal/sim/shoe/surface_mesh.hpp"

namespace biteline::sim {

/// First surface along a ray.
struct RayHit {
  double distance_mm;
  Vec3 normal;  ///< of the facet, unit, towards the ray's side
  SurfaceLook look;
};

/// Triangles in their own frame.  Immutable after build().  Thread: any number of threads may shoot at once.
class Scene {
 public:
  [[nodiscard]] static Result<Scene> build(const SurfaceMesh& mesh);

  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  /// Pre: |direction| = 1.  Distances accurate to single precision: 0.0001 mm at 1 m.
  [[nodiscard]] std::optional<RayHit> first_hit(const Vec3& origin, const Vec3& direction) const;

  /// Nothing stands between the point (on the surface) and the eye.
  [[nodiscard]] bool sees(const Vec3& eye, const Vec3& surface_point) const;

 private:
  struct Embree;
  explicit Scene(std::unique_ptr<Embree> embree);
  std::unique_ptr<Embree> embree_;
};

}  // namespace biteline::sim
