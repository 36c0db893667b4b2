// SPDX-License-Identifier: MIT
#include "common/stripe/peak_extractor_state.hpp"

namespace biteline::stripe {

void PeakExtractor::rt_extract(const PixelView& frame, Peaks& out) noexcept BITELINE_RT {
  State& state = *state_;
  const FrameRows rows{.pixels = frame.pixels,
                       .stride_bytes = frame.stride_bytes,
                       .width_px = state.width_px,
                       .height_px = state.height_px};
  rt_find_candidates(rows, state.config.threshold_grey, state.scratch);

  out.column_count = state.width_px;
  for (int column = 0; column < state.width_px; ++column) {
    ColumnPeaks& peaks = out.columns[static_cast<std::size_t>(column)];
    peaks.kept_count = 0;
    peaks.seen_count = 0;
    if (!state.column_mask.empty() && state.column_mask[static_cast<std::size_t>(column)] == 0) continue;
    const ColumnCandidates& candidates = state.scratch.candidates[static_cast<std::size_t>(column)];
    peaks.seen_count = candidates.seen_count;
    for (std::size_t i = 0; i < candidates.kept_count; ++i) {
      Peak& peak = peaks.kept[peaks.kept_count];
      if (rt_fit_peak(rows, column, candidates.kept[i], state.config, peak)) ++peaks.kept_count;
    }
  }
}

}  // namespace biteline::stripe
