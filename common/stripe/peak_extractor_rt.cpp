// SPDX-License-Identifier: MIT
#include "common/core/contracts.hpp"
#include "common/stripe/peak_extractor_state.hpp"

namespace biteline::stripe {

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
    std::uint8_t& seen_count = state.scratch.candidates.seen_count[column];
    if (!state.column_mask.empty() && state.column_mask[column] == 0) seen_count = 0;
    out.columns[column].kept_count = 0;
    out.columns[column].seen_count = seen_count;
  }
  rt_fit_candidates(rows, state.config, state.scratch, out);

  if (state.config.mode == PeakMode::Matched) return;
  for (int column = 0; column < state.width_px; ++column) {
    ColumnPeaks& peaks = out.columns[static_cast<std::size_t>(column)];
    for (std::size_t i = 0; i < peaks.kept_count; ++i)
      rt_apply_mode(rows, column, state.config.mode, peaks.kept[i]);
  }
}

}  // namespace biteline::stripe
