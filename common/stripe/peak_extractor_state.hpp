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

/// Blocks are counted in a byte.
inline constexpr int k_max_rows = 255 * k_block_rows;

/// A place to look at closely: the brightest of its surroundings, to within a block.
struct Candidate {
  std::uint8_t block{0};
  std::uint8_t value{0};
};

struct ColumnCandidates {
  std::array<Candidate, k_kept_peaks> kept;  ///< the highest first
  std::uint8_t kept_count{0};
  std::uint8_t seen_count{0};
};

/// The frame, with what the coarse pass needs to know about it.
struct FrameRows {
  const std::uint8_t* pixels;
  std::size_t stride_bytes;
  int width_px;
  int height_px;
};

/// Work space of the coarse pass.
struct CoarseScratch {
  /// Per column, a quiet level: what the column shows away from any stripe.
  std::vector<std::uint8_t> background;
  std::vector<std::uint8_t> threshold;  ///< background + PeakConfig::threshold_grey, saturated
  /// Block maxima of the lanes that rose above the threshold, in scan order within a lane, `k_lane_columns`
  /// each.
  std::vector<std::uint8_t> active_values;
  std::vector<std::uint8_t> active_blocks;   ///< block number of each entry
  std::vector<std::uint16_t> active_counts;  ///< entries per lane
  std::vector<ColumnCandidates> candidates;  ///< per column
};

/// Fills scratch.candidates.  `threshold_grey` above the column's own quiet level.
void rt_find_candidates(const FrameRows& frame, float threshold_grey,
                        CoarseScratch& scratch) noexcept BITELINE_RT;

/// At most this many columns in one vector of floats.
inline constexpr std::size_t k_max_lanes = 16;

/// Neighbouring columns whose candidates are fitted together.
struct FitGroup {
  std::size_t first_column{0};
  std::array<bool, k_max_lanes> used{};
  std::array<float, k_max_lanes> in_use{};      ///< the same as a number
  std::array<float, k_max_lanes> block_row{};   ///< first row of the candidate's block
  std::array<float, k_max_lanes> top{};         ///< the block's maximum
  std::array<float, k_max_lanes> background{};  ///< the column's quiet level
  int lowest_row{0};                            ///< of block_row over the used lanes
  int highest_row{0};
};

struct FittedLanes {
  std::array<float, k_max_lanes> centre, sigma, amplitude, background, sigma_centre, misfit, saturated;
};

/// Fits every candidate by the stripe's shape; those whose amplitude is too low are dropped.  Pre: out's
/// counts are 0.
void rt_fit_candidates(const FrameRows& frame, const PeakConfig& config, const CoarseScratch& scratch,
                       Peaks& out) noexcept BITELINE_RT;

/// Replaces a fitted peak's row by what `mode` says.  Pre: not Matched.
void rt_apply_mode(const FrameRows& frame, int column, PeakMode mode, Peak& peak) noexcept BITELINE_RT;

struct PeakExtractor::State {
  PeakConfig config;
  int width_px{0};
  int height_px{0};
  std::vector<std::uint8_t> column_mask;  ///< empty: all
  CoarseScratch scratch;
};

}  // namespace biteline::stripe
