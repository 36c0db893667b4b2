// SPDX-License-Identifier: MIT
#pragma once
/// \file A made side whose every place is known: an upright wall on an egg-shaped plan.

#include <cfenv>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line::test {

/// Plan from heel (x = 0) to toe (x = 280), wider in front, anticlockwise.
inline Vec2 egg(double turn_share) {
  const double t = 2 * std::numbers::pi * turn_share;
  return {140 + 140 * std::cos(t), (44 + 6 * std::cos(t)) * std::sin(t)};
}

inline Outline egg_outline() {
  std::vector<Vec2> curve;
  for (int i = 0; i < 1400; ++i) curve.push_back(egg(i / 1400.0));
  return Outline{curve, {.smoothing_mm = 0}};
}

struct DrumSteps {
  double s_mm{0.7};  ///< of profiles
  double z_mm{0.1};
  double z_begin_mm{0};
  double z_end_mm{60};
};

/// Points of a wall that stands out by `o_mm(s, z)`; where that is below -100 there is no point.
template <class O>
std::vector<Eigen::Vector3f> drum_points(const Outline& outline, O&& o_mm, const DrumSteps& steps = {}) {
  std::vector<Eigen::Vector3f> points;
  const int profiles = static_cast<int>(outline.length_mm() / steps.s_mm);
  for (int i = 0; i < profiles; ++i) {
    const double s = outline.length_mm() * i / profiles;
    for (double z = steps.z_begin_mm; z <= steps.z_end_mm; z += steps.z_mm) {
      const double o = o_mm(s, z);
      if (o < -100) continue;
      const Vec2 plan = outline.point(s) + o * outline.normal(s);
      points.emplace_back(static_cast<float>(plan.x()), static_cast<float>(plan.y()), static_cast<float>(z));
    }
  }
  return points;
}

inline constexpr double k_no_point = -1000;

/// A shoe of these points, as find_shoe() would hand it on: base and shoe are one frame.
inline Shoe shoe_of(const std::vector<Eigen::Vector3f>& points) {
  Shoe shoe;
  for (std::size_t i = 0; i < points.size(); ++i) {
    shoe.points.push_back(points[i]);
    shoe.index.push_back(static_cast<std::uint32_t>(i));
    shoe.alone.push_back(0);
    shoe.box.extend(points[i]);
  }
  shoe.length_mm = 280;
  shoe.width_mm = 90;
  return shoe;
}

template <class O>
Side drum_side(O&& o_mm, const DrumSteps& steps = {}) {
  Outline outline = egg_outline();
  Shoe shoe = shoe_of(drum_points(outline, o_mm, steps));
  SideField field = SideField::build(shoe, outline, {});
  return {std::move(shoe), std::move(outline), std::move(field)};
}

/// For teardown(): slopes of a made wall are next to 0, and the powers of them in the vector lanes' series
/// underflow, as they may.
inline void forgive_underflow() {
  std::feclearexcept(FE_UNDERFLOW);
}

/// A groove 1 mm deep whose bottom, where the section turns most, lies at `z_mm`.
inline double groove_mm(double z, double z_mm) {
  const double sigmas = (z - z_mm) / 0.6;
  return std::abs(sigmas) > 6 ? 0.0 : -std::exp(-0.5 * sigmas * sigmas);
}

}  // namespace biteline::bite_line::test
