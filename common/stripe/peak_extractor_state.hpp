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

/// Fits every candidate by the stripe's shape; those whose amplitude is too low are dropped.  Pre: out's
/// counts are 0.
void rt_fit_candidates(const FrameRows& frame, const PeakConfig& config, const CoarseScratch& scratch,
                       Peaks& out) noexcept BITELINE_RT;

/// Replaces a fitted peak's row by what `mode` says.  Pre: not Matched.
void rt_apply_mode(const FrameRows& frame, int column, PeakMode mode, Peak& peak) noexcept BITELINE_RT;

struct PeakExtractor::State {
  PeakConfig config;
  SearchPlan plan;
  int width_px{0};
  int height_px{0};
  CoarseScratch scratch;
};

}  // namespace biteline::stripe
