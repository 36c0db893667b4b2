// SPDX-License-Identifier: MIT
#pragma once
/// \file What a controller asks of a program's targets: how far apart they stand, how round it may go past
/// them, how many there may be.

#include <span>
#include <vector>

#include "host/robot/path/process.hpp"

namespace biteline::path {

/// Blends of neighbours must not meet: the controller skips such a move ("Overlapping Blends", UR user and
/// script manuals).  Each may take this much of the way to either neighbour; what is left is rounding.
constexpr double k_blend_share = 0.49;

/// Users report programs of more than about 1000 sent targets that do not start
/// (ros-industrial/universal_robot issue 411; visose/Robots issue 55: from 2500).  Fewer points within the
/// chord error are taken, never two programs: between two the tool would stand on the shoe.
constexpr std::size_t k_most_targets = 1000;

/// Of the line's own part; the ways there and back take the rest.
constexpr std::size_t k_most_line_targets = 950;

/// Steps between the line's targets: as the process wishes, but wide enough for its blends and for the
/// number of targets.  `way_mm` is the way of the tip along the line.
[[nodiscard]] double target_spacing_mm(const Motion& motion, double way_mm);

/// A place on a way given by close points: on the straight piece behind one of them.
struct FinePlace {
  std::size_t sample{0};
  double fraction{0};
  Vec3 tip{Vec3::Zero()};
};

/// Places to go through, evenly and at least `spacing_mm` apart in a straight line, as blends need it; the
/// first and the last one are the way's ends.  Pre: at least two points.
[[nodiscard]] std::vector<FinePlace> even_places(std::span<const Vec3> way, double spacing_mm);

/// How far the program leaves the way, and where, along the targets.
struct ChordError {
  double mm{0};
  double arc_mm{0};
};
/// Of the straight moves against the fine way, and of the parabolas that blends make of the corners (half
/// the radius times the sine of half the turn).
[[nodiscard]] ChordError chord_error(std::span<const Vec3> way, const std::vector<FinePlace>& places,
                                     double blend_mm);

/// Blend radius at each target: the wished one where both neighbours leave room, else what does; 0 at both
/// ends, where the tool stops.
[[nodiscard]] std::vector<double> blend_radii_mm(std::span<const Vec3> tips, double wished_mm);

}  // namespace biteline::path
