// SPDX-License-Identifier: MIT
#pragma once
/// \file Curvature of the sections, and the ridge of largest curvature along them: the crease itself.

#include <cstdint>
#include <span>
#include <vector>

#include "host/bite_line/place/sections.hpp"

namespace biteline::bite_line {

/// Curvature of every section at every row: o smoothed by the definition's Gaussian, then k = o'' / (1 +
/// o'^2)^1.5. Gaussian and its derivatives are folded into one pass; unknown rows leave k at 0.  Each stretch
/// of known rows is worked on by itself, and goes on straight beyond its ends.
///
/// The definition's section is upright.  `upright_ratio`: height for each millimetre across the line, per
/// station, where the sections are square to a line that climbs; empty: 1.
[[nodiscard]] PooledVector<float> section_curvature(const Sections& sections, double sigma_mm,
                                                    std::span<const double> upright_ratio = {});

/// Flatter than a radius of 12 mm is the shape of the shoe, not a crease.
inline constexpr double k_least_curvature_per_mm = 0.08;

struct Ridge {
  std::vector<double> row;       ///< per station, sub-row
  std::vector<double> k_per_mm;  ///< there
  std::vector<std::uint8_t> visible;
  /// Per station the sharpest other hollow of the section within the search range: its curvature, 0 without
  /// one, and how far off it lies.
  std::vector<double> other_k_per_mm;
  std::vector<double> other_mm;
};

/// Follows the largest curvature within the search range; continuity keeps it from hopping to a stitch or a
/// speck.
/// Another hollow is one that lies a millimetre and more from the ridge, with a dip between.
[[nodiscard]] Ridge follow_ridge(const Sections& sections, std::span<const float> k, double search_mm);

}  // namespace biteline::bite_line
