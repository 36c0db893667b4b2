// SPDX-License-Identifier: MIT
#pragma once
/// \file The line of a side that was levelled along a guide.

#include <optional>
#include <span>

#include "host/bite_line/extraction.hpp"
#include "host/bite_line/level/levelled.hpp"
#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// On the side itself.
struct AlongGuide {
  Decision decision;
  PlacedLine placed;  ///< empty when the decision is a refusal and not for review
};

/// Layers, decision and place as without a guide, but on the side levelled along it.  What a shoe's outline
/// is, `side` says.
[[nodiscard]] AlongGuide find_along_guide(const ScanPoints& scan, const Side& side, const Guide& guide,
                                          const std::optional<SeamStep>& seam, const Config& config);

}  // namespace biteline::bite_line
