// SPDX-License-Identifier: MIT
#pragma once
/// \file From what each row tells to stretches along the line.

#include <vector>

#include "host/second_look/raster.hpp"
#include "host/second_look/second_look.hpp"

namespace biteline::second_look {

/// What is wrong in one row, from where to where across.
struct Seen {
  FaultKind kind{FaultKind::Missing};
  double low_mm{0}, high_mm{0};
};
using SeenAt = std::vector<std::vector<Seen>>;  ///< per row

/// Rows on a line: where they are, and which of them say nothing of their own (`blank`).
struct RowsOnLine {
  const std::vector<double>& along_mm;  ///< rising
  const std::vector<std::uint8_t>& blank;
  double line_mm{0};

  [[nodiscard]] std::size_t size() const { return along_mm.size(); }
  /// From one row on to another; a whole turn from a row to itself.
  [[nodiscard]] double way_mm(std::size_t from, std::size_t to) const {
    const double way = along_mm[to] - along_mm[from];
    return way > 0 ? way : way + line_mm;
  }
};

/// Faults of one kind that overlap across and follow each other along are one.
[[nodiscard]] std::vector<Fault> join_faults(const SeenAt& seen, const RowsOnLine& rows,
                                             const LineFrame& frame, const SurfaceWays& ways);

/// Stretches of places that are unclear for one reason.
[[nodiscard]] std::vector<CannotTell> join_unclear(const std::vector<BandPlace>& places,
                                                   const RowsOnLine& rows);

}  // namespace biteline::second_look
