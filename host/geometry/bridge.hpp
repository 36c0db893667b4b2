// SPDX-License-Identifier: MIT
#pragma once
/// \file Across stretches of a closed line that were not seen.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"

namespace biteline::geometry {

/// Stations between two known ones: `first` is the last known one before them, `first + steps` (round the
/// line) the first known one behind.
struct Gap {
  std::size_t first{0};
  std::size_t steps{0};
};
/// None when nothing is known at all.
[[nodiscard]] std::vector<Gap> gaps_of(std::span<const std::uint8_t> known);

/// What is known over less than `longest_mm`, between gaps that are both longer, is a stray and not a sight
/// of the surface.
void drop_islands(std::vector<std::uint8_t>& known, double station_mm, double longest_mm);

/// Straight lines across the gaps.
void bridge_straight(std::vector<double>& values, std::span<const std::uint8_t> known, double station_mm);

/// Straight lines between the means of the last `ends_mm` on either side: for values that scatter from
/// station to station.
void bridge_means(std::vector<double>& values, std::span<const std::uint8_t> known, double station_mm,
                  double ends_mm);

/// Cubics that leave both ends with the slope of what is known of the last `lever_mm` before them.
void bridge_smooth(std::vector<double>& values, std::span<const std::uint8_t> known, double station_mm,
                   double lever_mm);

/// The cubic from p0 to p1 with these directions (any length) that is nearest to a circle: where they turn by
/// theta, its derivatives are 4 tan(theta / 4) radii long, and the chord is 2 sin(theta / 2) radii.  Place at
/// `share` of it.
struct Arc {
  Vec3 p0, d0;
  Vec3 p1, d1;
  [[nodiscard]] Vec3 at(double share) const;
  [[nodiscard]] double turn_rad() const;  ///< theta, at most 2.8: beyond it a cubic is no circle
};

/// How far the corner in which two ends meet lies beyond the straight line between them, in the middle.  The
/// turn counts up to 2.8 rad.
[[nodiscard]] double corner_beyond_chord_mm(double chord_mm, double turn_rad);

/// How far the corner in which two ends meet lies beyond the circle between them, in the middle: what lies
/// between may be as blunt as the circle or as sharp as the corner.
[[nodiscard]] double corner_beyond_arc_mm(double chord_mm, double turn_rad);

/// Over this length beside a gap the direction of its end is taken, and again over as much behind that.
inline constexpr double k_end_lever_mm = 6.0;

/// Direction at the very end of a curve, outwards (any length): over the lever beside it, turned on by half
/// of what it turns to the one behind.  `near` and `far` lie one and two levers back.
struct CurveEnd {
  Vec3 end, near, far;
  [[nodiscard]] Vec3 direction() const { return 1.5 * (end - near) - 0.5 * (near - far); }
};

}  // namespace biteline::geometry
