// SPDX-License-Identifier: MIT
#pragma once
/// \file Normals, mean and Gaussian curvature of scattered points: PCA and the level-set fit
/// (README.md).

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/bite_line/published/neighbour_grid.hpp"
#include "host/bite_line/published/solvers.hpp"

namespace biteline::published {

using curvature::Batch;

struct CurvatureConfig {
  Solver solver{Solver::LeastSquares};
  float radius_mm{1.5F};      ///< of the neighbourhoods, when `neighbours` is 0
  std::size_t neighbours{0};  ///< this many nearest instead, at most Batch::k_most_neighbours
  /// Levels at this share of the radius: well above the noise, within the quadric's reach.
  float offset_ratio{1.0F / 3.0F};
  /// Weights fall to exp(-1/2) at this share of the radius; 0: all weights 1.  At 1 the error of H is least
  /// on noisy balls, tubes and tori, and a valley as tight as the radius is still read right
  /// (tests/bench/line/bench_curvature).
  float weight_ratio{1.0F};
};

/// Per point of the cloud, in its order.
struct Curvature {
  std::vector<Eigen::Vector3f> normal;  ///< unit
  std::vector<float> mean_per_mm;       ///< convex > 0
  std::vector<float> gaussian_per_mm2;
  std::vector<std::uint8_t> trusted;  ///< 0: too few neighbours, or a fit without an answer (values are 0)
};

/// `outward` (optional): a rough outward direction per point that says which side of each normal is outside;
/// without it normals are made to agree from neighbour to neighbour and point away from the cloud's middle as
/// a whole.
///
/// Works on all threads of the calling arena.  Memory: 16 bytes per point for the grid, 36 for the results
/// and the normals in grid order, and one Batch per thread.
[[nodiscard]] Curvature estimate_curvature(std::span<const Eigen::Vector3f> points,
                                           std::span<const Eigen::Vector3f> outward,
                                           const CurvatureConfig& config);

/// Principal curvatures, the larger first: H + root, H - root with root = sqrt(max(0, H^2 - K)).
struct Principal {
  float larger_per_mm, smaller_per_mm;
};
[[nodiscard]] Principal principal(float mean_per_mm, float gaussian_per_mm2);

}  // namespace biteline::published
