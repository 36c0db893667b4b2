// SPDX-License-Identifier: MIT
#pragma once
/// \file What the distance from profile to profile means for the line between them.

#include <span>
#include <vector>

namespace biteline::bite_line {

/// Weights along the line: about six points within the definition's Gaussian and these (areas 1.0 mm by 2.5
/// sigma), at least two profiles of a usual scan.  Where profiles lie far apart, half-way between two of them
/// both count, and on one its neighbours hardly do.  Standard deviation, mm.
[[nodiscard]] double sigma_along_mm(double points_per_mm2, double sample_mm);

/// The weights are wider than two profiles, since that few points are there.
[[nodiscard]] bool are_few(double points_per_mm2);

/// Standard deviation of a straight course between profiles `sample_mm` apart, per station of a closed line.
/// Of a bend that its second differences over that distance tell, it is off by an eighth of those half-way,
/// and by sqrt(8 / 15) of that in the mean.
[[nodiscard]] std::vector<double> between_profiles(std::span<const double> values, double sample_mm,
                                                   double station_mm);

}  // namespace biteline::bite_line
