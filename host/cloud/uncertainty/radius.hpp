// SPDX-License-Identifier: MIT
#pragma once
/// \file Circles in the plane across a line that hold a normal distribution, or two.

#include <Eigen/Core>

namespace biteline::uncertainty {

/// Standard deviations along the principal axes of a normal distribution in a plane, the larger first, mm.
struct Axes {
  double major_mm{0};
  double minor_mm{0};
};
[[nodiscard]] Axes principal_axes(const Eigen::Matrix2d& covariance_mm2);

/// Probability that a place so distributed about 0 lies within a circle about 0.  The inner integral is an
/// error function, the outer one a Gauss-Legendre sum; good to 1e-6 for radii up to ten major deviations.
[[nodiscard]] double chance_within(const Axes& axes, double radius_mm);

/// The radius that holds the true line with 95 %, where it is there with `hold`, and with the rest
/// `other_mm` away.  Where even that is not said, the farther one counts.
[[nodiscard]] double u95_mm(const Axes& axes, double hold, double other_mm);

}  // namespace biteline::uncertainty
