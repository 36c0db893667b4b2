// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a scan's end comes back to its begin: a shoe that moved meanwhile is seen at two places.

#include <optional>

#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// How far out the surface lies at the scan's end beyond where it lay at its begin, by the median over the
/// heights.  None: the points are in no order, the end does not come within 10 mm of the begin, or hardly any
/// height shows both.
///
/// Only what moves the wall outwards shows: along itself a smooth wall looks the same.
[[nodiscard]] std::optional<double> seam_step_mm(const ScanPoints& scan, const Side& side);

}  // namespace biteline::bite_line
