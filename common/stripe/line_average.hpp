// SPDX-License-Identifier: MIT
#pragma once
/// \file Averaging along the stripe, as far as the surface allows and no further.

#include <array>
#include <cstdint>
#include <span>

#include "common/rt/annotations.hpp"
#include "common/stripe/peaks.hpp"

namespace biteline::stripe {

struct LineAverageConfig {
  /// Most columns on each side that one row may be drawn from; 0 turns averaging off.  Six columns are 0.8 mm
  /// of surface at 0.13 mm a column.
  int max_each_side{k_max_each_side};
  /// Two estimates may differ by this many standard deviations each and still be of one shape.
  float consistency_sigma{1.6F};

  static constexpr int k_max_each_side = 6;
};

/// One column's chosen peak.
struct LinePoint {
  float row_px{0};
  float sigma_row_px{0};
  bool present{false};
  bool joined{false};  ///< on one stretch with the previous column
};

/// Speckle moves a stripe's centre in each column alone; only neighbours can average it away.  Per column a
/// parabola is fitted to ever wider centred windows of its stretch, and the widest is taken whose value
/// agrees with those of all narrower ones within their standard deviations (intersection of confidence
/// intervals: Goldenshluger, Nemirovski 1997; Katkovnik 1999).  Where the surface bends faster than a
/// parabola, at a groove's rim and bottom, the narrow windows win and the shape stays; the standard deviation
/// that is returned is that of the window taken.
///
/// Thread: immutable.  RT: rt_average.
class LineAverage {
 public:
  explicit LineAverage(const LineAverageConfig& config);

  /// Overwrites rows and standard deviations.  `work` holds as many points as `line`;
  /// `neighbour_correlation` is Speckle's, 0 to 1.
  void rt_average(std::span<LinePoint> line, std::span<LinePoint> work,
                  float neighbour_correlation) const noexcept BITELINE_RT;

 private:
  static constexpr std::size_t k_windows = 4;
  /// Farther apart, errors are unrelated: 0.8 to the power of sixteen is 0.03.
  static constexpr std::size_t k_correlated_columns = 3;
  /// Half widths tried, and for each the weights of a parabola's value at its centre (Savitzky, Golay 1964).
  struct Window {
    int each_side{0};
    std::array<float, LineAverageConfig::k_max_each_side + 1> weight{};  ///< by distance from the centre
    /// Variance of the average over a single column's: what columns at each distance from each other add to
    /// it, times their errors' correlation.
    std::array<float, k_correlated_columns + 1> share{};
  };
  LineAverageConfig config_;
  std::array<Window, k_windows> windows_;
};

}  // namespace biteline::stripe
