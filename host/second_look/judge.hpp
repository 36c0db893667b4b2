// SPDX-License-Identifier: MIT
#pragma once
/// \file What each row tells of the band, and what is wrong with it.

#include <cstdint>
#include <vector>

#include "host/second_look/bands.hpp"
#include "host/second_look/change.hpp"
#include "host/second_look/faults.hpp"

namespace biteline::second_look {

/// Everything that the rows are judged by.
struct Bench {
  const LineFrame& frame;
  const SurfaceWays& ways;
  const PlannedBand& plan;
  const Zones& zones;
  const Change& change;
  const Expected& expected;
  const std::vector<std::uint8_t>& shown;
  const RowsOnLine& rows;
};

/// Whether the band was worked at each place, and its edges.  Gives what is wrong, by places on the line.
/// Pre: `places` has one for each row, with its place on the line and whether it is planned.
[[nodiscard]] std::vector<Fault> judge(const Bench& bench, std::vector<BandPlace>& places);

[[nodiscard]] bool within(const Arc& arc, double mm);

}  // namespace biteline::second_look
