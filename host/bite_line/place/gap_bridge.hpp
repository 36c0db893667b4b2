// SPDX-License-Identifier: MIT
#pragma once
/// \file How a line is carried across stretches that were not seen, and how wrong that is on the line itself.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/shoe/plan.hpp"
#include "host/geometry/bridge.hpp"

namespace biteline::bite_line {

/// Over this length beside a gap its slope in height is taken.
inline constexpr double k_height_lever_mm = 10.0;

/// Shorter ones are off by less than the scatter beside them.
[[nodiscard]] bool is_long(const geometry::Gap& gap, double station_mm);

/// Short gaps count as known: over a few millimetres the outline itself, along which they are bridged, tells
/// the direction.
[[nodiscard]] std::vector<std::uint8_t> known_but_for_short(std::span<const std::uint8_t> known,
                                                            double station_mm);
/// The arc over a gap of a closed plan that leaves both ends in their own directions; level, z = 0.
[[nodiscard]] geometry::Arc gap_arc(std::span<const Vec2> plan, const geometry::Gap& gap, double station_mm,
                                    double lever_mm = geometry::k_end_lever_mm);

/// Over one gap of a closed plan: midway between two arcs that its ends allow.
struct PlanBridge {
  geometry::Arc one, other;
  bool firm{true};  ///< or of an end no direction is known

  [[nodiscard]] Vec2 at(double share) const { return (0.5 * (one.at(share) + other.at(share))).head<2>(); }
  /// Standard deviation of the middle of two that are as good as each other, mm.
  [[nodiscard]] double off_mm(double share) const { return 0.5 * (one.at(share) - other.at(share)).norm(); }
  [[nodiscard]] double turn_rad() const { return firm ? one.turn_rad() : other.turn_rad(); }
};
/// The ends' directions are read over one lever and over two: where a seam or a joint lies right beside the
/// gap, these differ.  `known`: but for short gaps.  Empty where an end is not firm.
[[nodiscard]] std::optional<PlanBridge> firm_bridge(std::span<const Vec2> plan,
                                                    std::span<const std::uint8_t> known,
                                                    const geometry::Gap& gap, double station_mm);
/// Of an end that is not firm `outline`, whose stations the plan has, tells a direction: then midway between
/// that arc and the chord.
[[nodiscard]] PlanBridge plan_bridge(std::span<const Vec2> plan, std::span<const std::uint8_t> known,
                                     const geometry::Gap& gap, const Outline& outline, double station_mm);

/// What a gap hides is not known, but how this line bends elsewhere is: gaps of the same length are made
/// where the line was seen, all the way round, and bridged in the same way.  What those bridges are off by.
struct TriedBridge {
  static constexpr std::size_t k_eighths = 4;
  /// RMS at 1, 2, 3 and 4 eighths of the length from either end, mm; all 0 where the line was seen over less
  /// than three such gaps.
  std::array<double, k_eighths> rms_mm{};

  /// At `share` of the gap's length, mm; 0 at its ends, which are known.
  [[nodiscard]] double at(double share) const;
};
[[nodiscard]] TriedBridge tried_plan(std::span<const Vec2> plan, std::span<const std::uint8_t> known,
                                     const geometry::Gap& gap, double station_mm);
[[nodiscard]] TriedBridge tried_height(std::span<const double> z_mm, std::span<const std::uint8_t> known,
                                       const geometry::Gap& gap, double station_mm);
/// What bridges in height over the long gaps are off by on this line, per station; 0 where the crease was
/// seen.  `usual`: where such bridges may be tried.
[[nodiscard]] std::vector<double> tried_heights(std::span<const double> z_mm,
                                                std::span<const std::uint8_t> known,
                                                std::span<const std::uint8_t> usual, double station_mm);

/// How far a corner may lie outside at `share` of a gap's length, of what it may in the middle: both ends
/// hold place and direction, so that it grows with the square from them.
[[nodiscard]] inline double gap_swell(double share) {
  const double from_ends = 4 * share * (1 - share);
  return from_ends * from_ends;
}

}  // namespace biteline::bite_line
