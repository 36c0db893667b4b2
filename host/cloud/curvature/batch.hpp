// SPDX-License-Identifier: MIT
#pragma once
/// \file Many small fits at once: one neighbourhood per vector lane.

#include <array>
#include <cstddef>
#include <cstdint>

namespace biteline::curvature {

/// Sixteen neighbourhoods.  Row j holds the j-th neighbour of each; beyond a lane's own count its rows are
/// not read for their values, only multiplied by 0: they must be finite, which the initial zeros see to.
/// Coordinates are relative to the point and divided by the neighbourhood's radius.  About 150 kB, one per
/// thread.
struct Batch {
  static constexpr std::size_t k_lanes = 16;
  static constexpr std::size_t k_most_neighbours = 64;
  using Row = std::array<float, k_lanes>;

  std::size_t rows{0};      ///< neighbours of the fullest lane
  alignas(64) Row count{};  ///< neighbours of each lane
  /// Weight by distance: exp(-fall * d^2), d in radii; 0: all weights 1.
  float fall{0};
  alignas(64) std::array<Row, k_most_neighbours> x{}, y{}, z{};
  alignas(64) std::array<Row, k_most_neighbours> nx{}, ny{},
      nz{};  ///< neighbours' unit normals, for fit_level_sets()

  alignas(64) Row out_nx{}, out_ny{}, out_nz{};  ///< of fit_planes(): unit, either sign
  alignas(64) Row mean{}, gaussian{};            ///< of fit_level_sets(), per radius and per radius squared
  alignas(64) Row trust{};                       ///< 0 where the fit has no answer
  /// Monomials of the three levels, ten per row.
  alignas(64) std::array<Row, 3 * k_most_neighbours * 10> scratch{};
};

/// PCA: normal of the weighted plane through each neighbourhood.
void fit_planes(Batch& batch);

/// Level-set quadric f = a1 x^2 + ... + a10 through levels at -offset, 0 and +offset (in radii) of all
/// neighbours by weighted least squares, then H and K at the point itself:
///     K = g^T adj(F) g / |g|^4,    H = (|g|^2 tr F - g^T F g) / (2 |g|^3).
/// All columns are taken as exact: least variance when the noise is small against the radius
/// (tests/bench/line/bench_curvature).
void fit_level_sets(Batch& batch, float offset);

/// Name of the instruction set in use, for reports.
[[nodiscard]] const char* vector_target();

}  // namespace biteline::curvature
