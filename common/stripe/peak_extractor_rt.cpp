// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "common/core/contracts.hpp"
#include "common/stripe/peak_extractor_state.hpp"

namespace biteline::stripe {

namespace {

/// Pixels at full scale have no weight in the fit: where they are many, what is left may be one flank or a
/// part of the tails, and the fit sure of it.  The middle of their run knows better, though not sharply: a
/// fit that stands off it by more than the run's own doubt is no measurement of the stripe.
void rt_doubt_saturated(const FrameRows& frame, int column, Peak& peak) noexcept BITELINE_RT {
  constexpr std::uint8_t k_full = 255;
  constexpr int k_most_rows = 64;            // of a run, to either side
  constexpr float k_run_doubt_px = 1.5F;     // of its middle: a row of noise at either end
  constexpr float k_run_doubt_ratio = 0.1F;  // and what a stripe of uneven flanks shifts it by
  const auto full_at = [&](int row) {
    return row >= 0 && row < frame.height_px &&
           frame.pixels[static_cast<std::size_t>(row) * frame.stride_bytes +
                        static_cast<std::size_t>(column)] == k_full;
  };
  const int row =
      static_cast<int>(std::clamp(peak.row_px, 0.0F, static_cast<float>(frame.height_px - 1)) + 0.5F);
  int nearest = 0;
  while (nearest <= k_most_rows && !full_at(row - nearest) && !full_at(row + nearest)) ++nearest;
  if (nearest > k_most_rows) return;
  int first = full_at(row - nearest) ? row - nearest : row + nearest, last = first;
  while (first > row - 2 * k_most_rows && full_at(first - 1)) --first;
  while (last < row + 2 * k_most_rows && full_at(last + 1)) ++last;
  const float length_px = static_cast<float>(last - first + 1);
  const float off_px = std::fabs(peak.row_px - 0.5F * static_cast<float>(first + last));
  if (off_px <= k_run_doubt_px + k_run_doubt_ratio * length_px) return;
  peak.flags |= k_peak_poor_fit;
  peak.sigma_row_px = std::max(peak.sigma_row_px, off_px);
}

}  // namespace

void PeakExtractor::rt_extract(const PixelView& frame, Peaks& out) noexcept BITELINE_RT {
  State& state = *state_;
  const int height_px = frame.height_px == 0 ? state.height_px : frame.height_px;
  BITELINE_EXPECTS(height_px >= 2 * k_block_rows && height_px <= state.height_px);
  const FrameRows rows{.pixels = frame.pixels,
                       .stride_bytes = frame.stride_bytes,
                       .width_px = state.width_px,
                       .height_px = height_px};
  rt_find_candidates(rows, state.plan, state.scratch);

  out.column_count = state.width_px;
  for (std::size_t column = 0; column < static_cast<std::size_t>(state.width_px); ++column) {
    out.columns[column].kept_count = 0;
    out.columns[column].seen_count = state.scratch.candidates.seen_count[column];
  }
  rt_fit_candidates(rows, state.config, state.scratch, state.evidence, out);
  out.speckle = rt_estimate_speckle(rows, state.evidence, state.config.noise, out);
  rt_judge_speckle(state.evidence, out.speckle, state.config.noise.speckle_contrast, out);

  for (int column = 0; column < state.width_px; ++column) {
    ColumnPeaks& peaks = out.columns[static_cast<std::size_t>(column)];
    for (std::size_t i = 0; i < peaks.kept_count; ++i) {
      if ((peaks.kept[i].flags & k_peak_saturated) != 0) rt_doubt_saturated(rows, column, peaks.kept[i]);
    }
  }

  if (state.config.mode == PeakMode::Matched) return;
  for (int column = 0; column < state.width_px; ++column) {
    ColumnPeaks& peaks = out.columns[static_cast<std::size_t>(column)];
    for (std::size_t i = 0; i < peaks.kept_count; ++i)
      rt_apply_mode(rows, column, state.config.mode, peaks.kept[i]);
  }
}

}  // namespace biteline::stripe
