// SPDX-License-Identifier: MIT
// How much a coherent laser's speckle makes of the stripe, from the stripe itself.  Within some columns
// speckle alone changes the light of most of them; a surface's colour and shape change it more slowly, or in
// few columns.  So each column is compared with the mean of those to its left and right, and the median of
// the squares says how much is speckle: edges, print and grooves are few.  (Speckle: Goodman, Speckle
// Phenomena in Optics, 2007, chapter 4; what it does to a stripe's place: Dorsch, Haeusler, Herrmann 1994.)
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/stripe/peak_extractor_state.hpp"

namespace biteline::stripe {
namespace {

/// Columns that are compared are so far apart.  Speckle of the usual lenses is another one from the next but
/// one on; in photographs and blurred pictures from the fourth on, and there it ends to grow.
constexpr std::size_t k_lag_columns = 4;
/// Rows of the stripe between these columns, at most: farther apart it is not one surface.
constexpr float k_most_step_px = 6.0F;
/// Fitted height from which a stripe is saturated and not a grain of it alone.
constexpr float k_most_grey = 330.0F;
/// One column in so many is looked at: 400 of a stripe tell its speckle to 5 %.
constexpr std::size_t k_step_columns = 4;
/// Columns looked at that say enough.
constexpr int k_least_columns = 20;
/// Variance of one value less the mean of two, of unrelated ones of variance 1.
constexpr float k_difference_variance = 1.5F;
/// Of neighbours' errors, where it is not measured.
constexpr float k_usual_correlation = 0.42F;
/// The residual over the model's own energy, above which the shape is no stripe's: this, and what speckle of
/// this contrast makes of itself in all but a hundredth of the columns.  Two stripes four of their standard
/// deviations apart reach 0.4.
constexpr float k_poor_fit_ratio = 0.22F, k_poor_fit_per_contrast = 1.1F;
/// Median of the square of a normal deviate of variance 1.
constexpr float k_median_of_square = 0.4549F;
/// Where more of the crest is at full scale than this, how much more is not told by it.
constexpr float k_most_full_ratio = 0.6F;

/// Median of numbers from 2^-30 to 2^10, to 3 %; what is beyond counts as the end.
class LogMedian {
 public:
  void rt_add(float value) noexcept BITELINE_RT {
    const auto bits = static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(value) >> k_shift) - k_first;
    ++counts_[static_cast<std::size_t>(std::clamp<std::int32_t>(bits, 0, k_bins - 1))];
    ++total_;
  }
  [[nodiscard]] int count() const { return total_; }
  [[nodiscard]] float value() const {
    int before = 0;
    std::size_t bin = 0;
    while (bin + 1 < k_bins && 2 * (before + counts_[bin]) < total_) before += counts_[bin++];
    const auto low = std::bit_cast<float>((static_cast<std::uint32_t>(bin) + k_first) << k_shift);
    const auto high = std::bit_cast<float>((static_cast<std::uint32_t>(bin) + k_first + 1) << k_shift);
    const float part = (0.5F * static_cast<float>(total_) - static_cast<float>(before)) /
                       static_cast<float>(std::max(1, counts_[bin]));
    return low + part * (high - low);
  }

 private:
  static constexpr std::uint32_t k_shift = 20;  // eight bins from one power of two to the next
  static constexpr std::int32_t k_first = (127 - 30) << 3, k_bins = 40 << 3;
  std::array<std::int32_t, k_bins> counts_{};
  int total_{0};
};

/// Relative difference of the middle value to the mean of the outer ones.
float difference(float before, float middle, float after) {
  return (2 * middle - before - after) / (0.5F * (2 * middle + before + after));
}

/// The brightest peak of a column, where it is a whole one.  A grain that is saturated counts, a stripe that
/// is does not: to leave out the bright grains would make the speckle less than it is.
const Peak* comparable(const ColumnPeaks& column) {
  const bool whole = column.kept_count > 0 && (column.kept[0].flags & k_peak_clipped) == 0 &&
                     column.kept[0].amplitude < k_most_grey;
  return whole ? &column.kept[0] : nullptr;
}

/// What is left of the contrast where this share of the crest's pixels is cut off at full scale: the median
/// of differences of three gamma deviates, each cut off at its quantile, to 0.02 for contrasts of 0.15 to
/// 0.6.
float cut_contrast(float full_ratio) {
  const float cut = std::min(full_ratio, k_most_full_ratio);
  return 1 - 1.28F * cut * std::cbrt(cut);
}

/// Height of the pixel on the stripe's crest, what the camera's own noise makes of it, squared, and whether
/// it is at full scale.
struct Crest {
  float grey;
  float noise_ratio2;
  bool full;
};
Crest rt_crest(const FrameRows& frame, std::size_t column, const Peak& peak,
               const NoiseModel& noise) noexcept BITELINE_RT {
  const auto row =
      static_cast<std::size_t>(std::clamp(peak.row_px, 0.0F, static_cast<float>(frame.height_px - 1)) + 0.5F);
  const std::uint8_t pixel = frame.pixels[row * frame.stride_bytes + column];
  const float grey = std::max(1.0F, static_cast<float>(pixel) - peak.background);
  return {
      .grey = grey,
      .noise_ratio2 = (noise.read_noise_grey * noise.read_noise_grey + noise.gain_grey_per_electron * grey) /
                      (grey * grey),
      .full = pixel == 255};
}

/// Columns at one distance from each other.
struct Triple {
  const Peak *before, *at, *after;
  std::size_t middle, lag;
};

/// Calls `look` for each three columns `lag` apart that show one surface.
template <class Look>
void rt_each_triple(const Peaks& peaks, std::size_t lag, Look look) noexcept BITELINE_RT {
  const auto columns = static_cast<std::size_t>(peaks.column_count);
  for (std::size_t middle = lag; middle + lag < columns; middle += k_step_columns) {
    const Triple triple{.before = comparable(peaks.columns[middle - lag]),
                        .at = comparable(peaks.columns[middle]),
                        .after = comparable(peaks.columns[middle + lag]),
                        .middle = middle,
                        .lag = lag};
    if (triple.before == nullptr || triple.at == nullptr || triple.after == nullptr) continue;
    if (std::fabs(triple.before->row_px - triple.at->row_px) > k_most_step_px ||
        std::fabs(triple.after->row_px - triple.at->row_px) > k_most_step_px)
      continue;
    look(triple);
  }
}

/// Power of the speckle in the stripe's light: of the columns' differences, less the camera's noise.
class LightPower {
 public:
  void rt_add(const Triple& three, const FitEvidence& known) noexcept BITELINE_RT {
    if (known.light_gain < k_least_gain) return;  // hardly a pixel below full scale
    const float ratio =
        difference(three.before->amplitude, three.at->amplitude, three.after->amplitude) +
        known.light_per_width * difference(three.before->width_px, three.at->width_px, three.after->width_px);
    squares_.rt_add(ratio * ratio / known.light_gain);
    noise_.rt_add(known.light_variance / known.light_gain);
  }
  [[nodiscard]] int count() const { return squares_.count(); }
  /// Of differences: k_difference_variance times that of unrelated columns.
  [[nodiscard]] float value_px() const {
    return std::max(k_least_power_px,
                    squares_.value() / k_median_of_square - k_difference_variance * noise_.value());
  }

 private:
  static constexpr float k_least_gain = 1e-3F, k_least_power_px = 1e-6F;
  LogMedian squares_, noise_;
};

/// Variance of a difference of neighbours over one value's, where the correlation is r^(distance^2), as in
/// light that optics blur.  Of columns k_lag_columns apart it is k_difference_variance: 0.8^16 is nothing.
float passed_by_neighbours(float r) {
  return k_difference_variance - 2 * r + 0.5F * r * r * r * r;
}

}  // namespace

Speckle rt_estimate_speckle(const FrameRows& frame, const Evidence& evidence, const NoiseModel& expected,
                            const Peaks& peaks) noexcept BITELINE_RT {
  LightPower far, near;
  LogMedian crest_squares, crest_noise;
  int full_count = 0;
  rt_each_triple(peaks, k_lag_columns, [&](const Triple& three) {
    far.rt_add(three, evidence[0][three.middle]);
    const Crest before = rt_crest(frame, three.middle - three.lag, *three.before, expected),
                at = rt_crest(frame, three.middle, *three.at, expected),
                after = rt_crest(frame, three.middle + three.lag, *three.after, expected);
    const float ratio = difference(before.grey, at.grey, after.grey);
    crest_squares.rt_add(ratio * ratio);
    crest_noise.rt_add(at.noise_ratio2);
    full_count += at.full ? 1 : 0;
  });
  rt_each_triple(peaks, 1, [&](const Triple& three) { near.rt_add(three, evidence[0][three.middle]); });
  const float expected_power_px =
      expected.speckle_contrast * expected.speckle_contrast * expected.speckle_grain_px;
  Speckle speckle{.contrast = expected.speckle_contrast,
                  .power_px = expected_power_px,
                  .neighbour_correlation = k_usual_correlation};
  if (far.count() < k_least_columns || near.count() < k_least_columns) return speckle;
  speckle.measured = true;
  speckle.power_px =
      std::max(far.value_px() / k_difference_variance,
               expected.speckle_contrast_min * expected.speckle_contrast_min * expected.speckle_grain_px);
  const float full_ratio = static_cast<float>(full_count) / static_cast<float>(crest_squares.count());
  speckle.contrast =
      std::sqrt(std::max(
          0.0F, crest_squares.value() / (k_median_of_square * k_difference_variance) - crest_noise.value())) /
      cut_contrast(full_ratio);
  speckle.doubt_ratio = std::sqrt(std::max(1.0F, expected_power_px / speckle.power_px));
  const float neighbours = near.value_px() / speckle.power_px;
  float low = 0.02F, high = 0.8F;  // less is nothing, more is not told apart
  for (int i = 0; i < 8; ++i) {
    const float r = 0.5F * (low + high);
    (passed_by_neighbours(r) > neighbours ? low : high) = r;
  }
  speckle.neighbour_correlation = 0.5F * (low + high);
  return speckle;
}

void rt_judge_speckle(const Evidence& evidence, const Speckle& speckle, float least_contrast,
                      Peaks& peaks) noexcept BITELINE_RT {
  const float poor = k_poor_fit_ratio + k_poor_fit_per_contrast * std::max(speckle.contrast, least_contrast);
  for (std::size_t i = 0; i < static_cast<std::size_t>(peaks.column_count); ++i) {
    for (std::size_t k = 0; k < peaks.columns[i].kept_count; ++k) {
      const FitEvidence& known = evidence[k][i];
      Peak& peak = peaks.columns[i].kept[k];
      peak.sigma_row_px = std::sqrt(known.centre_variance + known.centre_gain * speckle.power_px);
      if (known.misfit > poor) peak.flags |= k_peak_poor_fit;
    }
  }
}

}  // namespace biteline::stripe
