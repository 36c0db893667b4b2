// SPDX-License-Identifier: MIT
#pragma once
/// \file What holds the shoe above the table: it must not be touched either.

#include "host/cloud/closed_line.hpp"
#include "host/robot/path/checks/obstacles.hpp"

namespace biteline::path {

/// A plate or a post under the shoe, down to the table.
struct Fixture {
  double top_z_mm{0};    ///< in the line's frame: where the sole stands
  double beyond_mm{30};  ///< of the plate, beyond the line, all round
};

/// The block as wide as line and plate: its sides and its rim for arm and tool, its top for the tip.  A top
/// that is not above the table adds nothing.
void add_fixture(Surroundings& surroundings, const cloud::ClosedLine& line_base, const Fixture& fixture);

/// The highest thing under a tip at this place: the fixture's top, or the table.
[[nodiscard]] double floor_mm(const Surroundings& surroundings, const Vec3& tip_base);

}  // namespace biteline::path
