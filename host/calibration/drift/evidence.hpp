// SPDX-License-Identifier: MIT
#pragma once
/// \file What one scan says about its own calibration: under a wrong one, places that it saw twice do not
/// agree, and the table is not where it was.

#include <optional>

#include "common/core/result.hpp"
#include "host/calibration/drift/scan_view.hpp"
#include "host/calibration/drift/sums.hpp"
#include "host/calibration/drift/table_seen.hpp"

namespace biteline::drift {

struct Evidence {
  Sums seam{};          ///< of the places seen twice; zero where there are none
  double before_mm{0};  ///< how far the two views of a place lie apart, root mean square
  double after_mm{0};   ///< the same, if the head had drifted as it looks
  std::size_t pairs{0};
  std::size_t profiles{0};  ///< that saw a place again
  std::optional<TableEvidence> table{};

  /// Both together, the table counted from the usual one; another table than that says nothing.  Without a
  /// usual one it counts from where it is: no change of it is seen.
  [[nodiscard]] Sums sums(const std::optional<TablePlane>& usual = std::nullopt) const;
};

/// Cost: some 0.1 s of one core.  Errc::Degenerate where hardly any surface is seen twice, and no table.
[[nodiscard]] Result<Evidence> look_at(const ScanView& scan, const geometry::SensorModel& head);

}  // namespace biteline::drift
