// SPDX-License-Identifier: MIT
#pragma once
/// \file The outermost layer of a shoe's side: linings, insoles and far walls seen through the opening lie
/// behind it.

#include <span>

#include "host/bite_line/buckets.hpp"
#include "host/bite_line/shoe/outline_lookup.hpp"

namespace biteline::bite_line {

/// How far inside the outline a surface may lie: a toe's top does.
inline constexpr float k_inner_mm = 44.0F;

/// Where along the outline a place lies that was taken out, and may be a hollow's bottom: less than this
/// behind the envelope, with nothing in front of it at its own height.  Negative: it is none.
inline constexpr float k_hollow_mm = 0.6F;
[[nodiscard]] constexpr float hollow_s_mm(const OutlinePlace& place) {
  return -2 - place.s_mm;
}

struct OuterLayerConfig {
  double length_mm{0};  ///< of the outline
  double z_low_mm{0};
  double height_mm{0};
  double gap_mm{1.5};    ///< what lies this far behind the outermost surface is another layer
  double depth_mm{0.6};  ///< below the envelope of its neighbourhood a point is behind the surface: six times
                         ///< a scan's worst noise
};

/// Takes the points behind the outermost layer, and those above the height, out: their s becomes negative.
/// One that may be the bottom of a hollow narrower than the envelope's rows keeps it for hollow_s_mm().
///
/// Twice: a clear gap behind the outermost cluster of a coarse cell separates a lining; then whatever is
/// deeper than the outermost points at its own height and at those just above and below lies behind the
/// surface (an insole at the height of the bite line has no gap).
///
/// Returns the points that had a place, by column of at least 2 mm along the outline.
Buckets keep_outer_layer(std::span<OutlinePlace> places, const OuterLayerConfig& config);

}  // namespace biteline::bite_line
