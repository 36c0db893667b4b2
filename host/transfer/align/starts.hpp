// SPDX-License-Identifier: MIT
#pragma once
/// \file First guesses of how a sample lies on an upper, each tried coarsely.

#include <vector>

#include "host/transfer/align/alignment.hpp"

namespace biteline::transfer {

// Wide enough for the difference of a sample's part above the line and a whole upper, and for 10 degrees at
// half a shoe.
inline constexpr double k_coarse_reach_mm = 30;
inline constexpr double k_middle_reach_mm = 12;

/// Two frames, six turns about the upright, two heights.  `source` is coarse and already graded.
[[nodiscard]] std::vector<Placement> starts(const Surfels& source, const Upper& upper, const Grade& grade);

[[nodiscard]] Surfels graded(const Surfels& surfels, const Grade& grade);

/// Of a sample whose part above the line is so long: by the upper's length, and what the law makes of that.
[[nodiscard]] Grade start_grade(const GradingLaw& law, double length_mm, const Upper& upper);

/// Best first, no two alike (5 mm at the source's `centre`, 5 degrees).
[[nodiscard]] std::vector<IcpResult> different_ones(std::vector<IcpResult> fits, const Vec3& centre);

/// As different_ones().  At least one.
[[nodiscard]] std::vector<IcpResult> coarse_fits(const Sample& sample, const Upper& upper,
                                                 const AlignOptions& options);

}  // namespace biteline::transfer
