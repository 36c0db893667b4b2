// SPDX-License-Identifier: MIT
#pragma once
/// \file The published ways to fit the level sets, and the product's own beside them.

#include <cstdint>

#include "host/cloud/curvature/batch.hpp"

namespace biteline::published {

/// How f = a1 x^2 + ... + a10 is fitted, with M a = b over all neighbours and levels.
enum class Solver : std::uint8_t {
  WeightedPca,   ///< published: eigenvector of the least eigenvalue of [M | -b]^T W [M | -b]; W twice:
                 ///< distance, then residual too
  PlainSvd,      ///< published, for comparison: f = 0 on the points alone, no levels, all weights 1
  LeastSquares,  ///< the product's own (host/cloud/curvature)
};

/// As curvature::fit_level_sets(), by the solver.
void fit_level_sets(curvature::Batch& batch, Solver solver, float offset);

}  // namespace biteline::published
