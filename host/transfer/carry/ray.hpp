// SPDX-License-Identifier: MIT
#pragma once
/// \file Rays against a scanned surface, whatever the surface is made of.

#include <optional>

#include "common/geometry/se3.hpp"

namespace biteline::transfer {

/// Looked along both ways: distances from -reach to +reach.
struct Ray {
  Vec3 origin{Vec3::Zero()};
  Vec3 direction{Vec3::UnitX()};  ///< unit, outward
  double reach_mm{0};
};

struct Hit {
  double distance_mm{0};  ///< along the ray, signed
  Vec3 position{Vec3::Zero()};
  Vec3 normal{Vec3::UnitX()};  ///< unit, outward
};

/// The nearest plausible hit: the surface there looks along the ray, not back nor aside.
class RaySurface {
 public:
  virtual ~RaySurface() = default;
  [[nodiscard]] virtual std::optional<Hit> cast(const Ray& ray) const = 0;
};

/// One surface, and another where the first has no hit: a mesh, and the stray points that are too few for
/// one. Holds references: lives no longer than both.
class FirstOf : public RaySurface {
 public:
  FirstOf(const RaySurface& first, const RaySurface& second) : first_{first}, second_{second} {}
  [[nodiscard]] std::optional<Hit> cast(const Ray& ray) const override {
    const std::optional<Hit> hit = first_.cast(ray);
    return hit ? hit : second_.cast(ray);
  }

 private:
  const RaySurface& first_;
  const RaySurface& second_;
};

/// Least cosine between ray and outward normal for a hit to be plausible: 75 degrees.  A wall met more aslant
/// gives the crossing's place no better than four times the noise.
inline constexpr double k_min_facing_cosine = 0.26;

}  // namespace biteline::transfer
