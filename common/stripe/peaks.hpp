// SPDX-License-Identifier: MIT
#pragma once
/// \file What one frame's columns show: at most two kept peaks each.

#include <array>
#include <cstddef>
#include <cstdint>

namespace biteline::stripe {

inline constexpr std::size_t k_max_columns = 2592;
inline constexpr std::size_t k_kept_peaks = 2;

enum PeakFlag : std::uint8_t {
  k_peak_saturated = 1U << 0U,  ///< pixels at full scale within the stripe
  k_peak_clipped = 1U << 1U,    ///< the stripe runs over the region's edge
  k_peak_wide = 1U << 2U,       ///< wider than PeakConfig::width_max_px
  k_peak_narrow = 1U << 3U,     ///< narrower than PeakConfig::width_min_px: a hot pixel, spatter
  k_peak_poor_fit =
      1U << 4U,  ///< not of the stripe's shape: two stripes run together, a broken one, or speckle
};

struct Peak {
  float row_px{0};        ///< sub-pixel row in the region; 0 is the centre of its first row
  float sigma_row_px{0};  ///< standard deviation of row_px by the noise model
  float amplitude{0};     ///< height above background, grey levels
  float width_px{0};      ///< full width at half maximum
  float background{0};    ///< grey levels
  /// Share of (u^3 - 3/2 u) g(u) in the shape A g(u), u in standard deviations: 0 for a symmetric one, about
  /// -0.09 where the stripe is dark beyond a standard deviation from its centre, on the side of the higher
  /// rows.
  float skew{0};
  std::uint8_t flags{0};  ///< PeakFlag
};

/// One column: the kept peaks, the strongest first.
struct ColumnPeaks {
  std::array<Peak, k_kept_peaks> kept;
  std::uint8_t kept_count{0};
  std::uint8_t seen_count{0};  ///< peaks above the threshold, kept or not; saturates at 255
};

/// What the laser's coherence makes of a stripe, as the stripe itself shows it.
struct Speckle {
  float contrast{0};  ///< standard deviation over mean of one pixel on the stripe's crest
  /// Contrast squared times the rows that go together: the variance of a mean over n rows is this over n.
  float power_px{0};
  /// Correlation of neighbouring columns' errors.
  float neighbour_correlation{0};
  /// By so much more than measured the noise may be that NoiseModel expects: what is judged by its shape is
  /// judged by that.  At least 1.
  float doubt_ratio{1};
  bool measured{false};  ///< false: too few columns, the values are those that were expected
};

/// Fixed capacity; lives where its owner puts it (130 kB: not on a thread's stack).
struct Peaks {
  int column_count{0};
  Speckle speckle{};
  std::array<ColumnPeaks, k_max_columns> columns;
};

}  // namespace biteline::stripe
