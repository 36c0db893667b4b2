// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a scan's end comes back to its begin: a shoe that moved meanwhile is seen at two places.

#include <optional>

#include "common/core/fixed_text.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/shoe/shoe.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::bite_line {

/// No sound scan is near it: recorded ones read 0.04 mm at most, made ones 0.15 mm.
inline constexpr double k_most_seam_step_mm = 0.5;

/// How far out the surface lies at the scan's end beyond where it lay at its begin, by the median over the
/// heights.  None: the points are in no order, the end does not come within 10 mm of the begin, or hardly any
/// height shows both.
///
/// Only what moves the wall outwards shows: along itself a smooth wall looks the same.
[[nodiscard]] std::optional<double> seam_step_mm(const ScanPoints& scan, const Shoe& shoe,
                                                 const Outline& outline);
/// The same for a cloud whose line is not looked for.  None where it holds no shoe, too.
[[nodiscard]] std::optional<double> seam_step_mm(const cloud::PointCloud& cloud);

/// Why a scan with such a step gets no line.
[[nodiscard]] FixedText<240> does_not_close(double seam_step_mm);

}  // namespace biteline::bite_line
