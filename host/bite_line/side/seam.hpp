// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a scan's end comes back to its begin: a shoe that moved meanwhile is seen at two places.

#include <optional>

#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/shoe/shoe.hpp"
#include "host/bite_line/side/seam_step.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::bite_line {

/// At places 10 mm apart, as far as end and begin overlap, the two are compared by the median over the
/// heights, and the likeliest motion of the shoe is laid through these steps.  Below 40 mm of overlap there
/// is one place, and no turn is seen.  None: the points are in no order, the end does not come within 10 mm
/// of the begin, or hardly any height shows both.
///
/// Only what moves the wall outwards shows: a shoe that moves along a flat wall there is not seen.
[[nodiscard]] std::optional<SeamStep> seam_step(const ScanPoints& scan, const Shoe& shoe,
                                                const Outline& outline);
/// The same for a cloud whose line is not looked for.  None where it holds no shoe, too.
[[nodiscard]] std::optional<SeamStep> seam_step(const cloud::PointCloud& cloud);

}  // namespace biteline::bite_line
