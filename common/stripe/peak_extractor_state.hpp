// SPDX-License-Identifier: MIT
#pragma once
/// \file Inside of PeakExtractor: shared by its set-up (allocates) and its hot path (fenced), and by nobody
/// else.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/stripe/peak_extractor.hpp"

namespace biteline::stripe {

/// Rows whose maximum is taken together in the pass over the frame.  Eight streams are what the prefetchers
/// of x86 and Cortex-A cores follow at once; two stripes in one column less than two blocks apart count as
/// one peak.
inline constexpr int k_block_rows = 8;

/// A vector's worth of columns in which some block maximum rose above the threshold.
inline constexpr int k_lane_columns = 64;

/// Blocks are numbered in a byte, 0 to 255.
inline constexpr int k_max_rows = 256 * k_block_rows;

/// How the frame is searched.
struct SearchPlan {
  int threshold_grey{0};  ///< a block is of interest above the column's quiet level by more than this
  /// Of the rows, one in so many is read for every column: 1, 2 or 4.
  int row_stride{1};
  /// Only where a row that is read rises above the quiet level by more than this are the rows between read
  /// too.
  int suspect_grey{0};
};

/// The widest stride at which no stripe of the permitted width slips between the rows (proof at its
/// definition).
[[nodiscard]] SearchPlan plan_search(const PeakConfig& config);

/// The frame, with what the coarse pass needs to know about it.
struct FrameRows {
  const std::uint8_t* pixels;
  std::size_t stride_bytes;
  int width_px;
  int height_px;
};

/// Places to look at closely: the brightest of their surroundings, to within a block.  One entry per column.
struct Candidates {
  std::array<std::vector<std::uint8_t>, k_kept_peaks> block;  ///< the highest first
  std::array<std::vector<std::uint8_t>, k_kept_peaks> value;  ///< the block's maximum
  std::vector<std::uint8_t> seen_count;                       ///< saturates at 255; the highest two are kept
};

/// Work space of the coarse pass.
struct CoarseScratch {
  /// Per column, a quiet level: what the column shows away from any stripe.
  std::vector<std::uint8_t> background;
  std::vector<std::uint8_t> threshold;  ///< background + SearchPlan::threshold_grey, saturated
  std::vector<std::uint8_t> suspect;    ///< background + SearchPlan::suspect_grey, saturated
  /// Block maxima of the lanes that rose above the threshold, in scan order within a lane, `k_lane_columns`
  /// each.
  std::vector<std::uint8_t> active_values;
  std::vector<std::uint8_t> active_blocks;   ///< block number of each entry
  std::vector<std::uint16_t> active_counts;  ///< entries per lane
  std::vector<std::uint16_t> suspect_lanes;  ///< of the present block
  Candidates candidates;
};

/// Fills scratch.candidates.
void rt_find_candidates(const FrameRows& frame, const SearchPlan& plan,
                        CoarseScratch& scratch) noexcept BITELINE_RT;

/// At most this many columns in one vector of floats.
inline constexpr std::size_t k_max_lanes = 16;

/// Variance of a pixel for the weights of the fit, at mean grey value m: read + gain m + (contrast m)^2.
struct FitWeights {
  float read_variance_grey2{0};
  float gain_grey{0};
  float contrast{0};
};

/// What a peak's fit knows about its own errors, for one column or a vector of them.  Speckle's part of a
/// variance is its gain times the speckle's power (Speckle::power_px); the rest is the camera's.
template <class Value>
struct FitEvidenceOf {
  Value misfit;           ///< residual's share of the model's energy, a ratio of heights
  Value centre_variance;  ///< of the row, px^2, by the camera's noise alone
  Value centre_gain;      ///< of the row's variance, px
  Value light_variance;   ///< relative, of the light as rt_estimate_speckle() compares it, likewise
  Value light_gain;       ///< per pixel
  Value light_per_width;  ///< relative change of the height that one of the width makes up for in that light
};
using FitEvidence = FitEvidenceOf<float>;

/// By column, of the first and second kept peak.
using Evidence = std::array<std::vector<FitEvidence>, k_kept_peaks>;

/// Fits every candidate by the stripe's shape; those whose amplitude is too low are dropped.  Rows' standard
/// deviations and k_peak_poor_fit are left to rt_judge_speckle().  Pre: out's counts are 0.
void rt_fit_candidates(const FrameRows& frame, const PeakConfig& config, const CoarseScratch& scratch,
                       Evidence& evidence, Peaks& out) noexcept BITELINE_RT;

/// The speckle as the fitted stripe shows it; `expected` where too few columns show any.
[[nodiscard]] Speckle rt_estimate_speckle(const FrameRows& frame, const Evidence& evidence,
                                          const NoiseModel& expected,
                                          const Peaks& peaks) noexcept BITELINE_RT;

/// Gives each peak its standard deviation and, where it is not of the stripe's shape beyond what the speckle
/// makes of itself, k_peak_poor_fit.
void rt_judge_speckle(const Evidence& evidence, const Speckle& speckle, float least_contrast,
                      Peaks& peaks) noexcept BITELINE_RT;

/// Replaces a fitted peak's row by what `mode` says.  Pre: not Matched.
void rt_apply_mode(const FrameRows& frame, int column, PeakMode mode, Peak& peak) noexcept BITELINE_RT;

struct PeakExtractor::State {
  PeakConfig config;
  SearchPlan plan;
  int width_px{0};
  int height_px{0};
  CoarseScratch scratch;
  Evidence evidence;
};

}  // namespace biteline::stripe
