// SPDX-License-Identifier: MIT
#include "common/stripe/peak_extractor.hpp"

#include <hwy/targets.h>

#include <algorithm>
#include <cmath>

#include "common/core/contracts.hpp"
#include "common/stripe/peak_extractor_state.hpp"

namespace biteline::stripe {

PeakExtractor::PeakExtractor(std::unique_ptr<State> state) : state_{std::move(state)} {}
PeakExtractor::PeakExtractor(PeakExtractor&&) noexcept = default;
PeakExtractor& PeakExtractor::operator=(PeakExtractor&&) noexcept = default;
PeakExtractor::~PeakExtractor() = default;

/// A block is of interest when its brightest pixel, at row r, stands above the quiet level by more than the
/// threshold t.  The stripe's centre c lies within half a row of r.  With every S-th row read, S = 2 or 4,
/// one of those is no farther from c than S / 2 (the rows read lie 1 or 2 rows from the blocks' borders, so
/// no two are farther apart than S across them either); blurred by a Gaussian of standard deviation s or more
/// it shows at least exp(-(S / 2)^2 / (2 s^2)) of the top.  With s = width_min_px / 2.3548 a block that shows
/// no more than t times that on every row read therefore has no permitted stripe above t between them.  This
/// is so to within the noise, as is passing t itself; where the lowered threshold would come down into the
/// noise, and for narrower stripes than that, there is the next smaller stride, down to every row.  A stripe
/// whose centre is beyond the region's border may stay unseen: it could not be measured.
SearchPlan plan_search(const PeakConfig& config) {
  constexpr float k_noise_sigma = 4;  // of read noise: one false suspicion in 30 000 pixels costs nothing
  const float sigma_min_px = config.width_min_px / 2.3548F;
  SearchPlan plan{.threshold_grey = static_cast<int>(config.threshold_grey)};
  plan.suspect_grey = plan.threshold_grey;
  for (const int stride : {2, 4}) {
    const float reach =
        std::min(0.5F * static_cast<float>(stride) / sigma_min_px, 6.0F);  // exp(-18): nothing left
    const float lowered_grey = config.threshold_grey * std::exp(-0.5F * reach * reach);
    if (lowered_grey < k_noise_sigma * config.noise.read_noise_grey || lowered_grey < 1) break;
    plan.row_stride = stride;
    plan.suspect_grey = static_cast<int>(lowered_grey);
  }
  return plan;
}

Result<PeakExtractor> PeakExtractor::create(const PeakConfig& config, int width_px, int height_px) {
  if (width_px < static_cast<int>(k_max_lanes) || width_px > static_cast<int>(k_max_columns)) {
    return fail(Errc::InvalidArgument, "frame width %d: %zu to %zu expected", width_px, k_max_lanes,
                k_max_columns);
  }
  if (height_px < 2 * k_block_rows || height_px > k_max_rows) {
    return fail(Errc::InvalidArgument, "frame height %d: %d to %d expected", height_px, 2 * k_block_rows,
                k_max_rows);
  }
  if (!(config.threshold_grey >= 1 && config.threshold_grey <= 254)) {
    return fail(Errc::InvalidArgument, "threshold_grey %g: 1 to 254 expected",
                static_cast<double>(config.threshold_grey));
  }
  if (!(config.width_min_px > 0 && config.width_max_px > config.width_min_px)) {
    return fail(Errc::InvalidArgument, "stripe width %g to %g px: rising positive limits expected",
                static_cast<double>(config.width_min_px), static_cast<double>(config.width_max_px));
  }
  if (!(config.noise.read_noise_grey > 0 && config.noise.gain_grey_per_electron >= 0 &&
        config.noise.speckle_contrast >= 0 && config.noise.speckle_grain_px >= 1)) {
    return fail(Errc::InvalidArgument,
                "noise model: positive read noise and a grain of a pixel or more expected");
  }

  auto state = std::make_unique<State>();
  state->config = config;
  state->plan = plan_search(config);
  state->width_px = width_px;
  state->height_px = height_px;
  const std::size_t lanes = (static_cast<std::size_t>(width_px) + k_lane_columns - 1) / k_lane_columns;
  const std::size_t columns = lanes * k_lane_columns;
  const std::size_t blocks = (static_cast<std::size_t>(height_px) + k_block_rows - 1) / k_block_rows;
  state->scratch.background.assign(columns, 0);
  state->scratch.threshold.assign(columns, 0);
  state->scratch.active_values.assign(columns * blocks, 0);
  state->scratch.active_blocks.assign(lanes * blocks, 0);
  state->scratch.active_counts.assign(lanes, 0);
  state->scratch.suspect.assign(columns, 0);
  state->scratch.suspect_lanes.assign(lanes, 0);
  for (std::size_t rank = 0; rank < k_kept_peaks; ++rank) {
    state->scratch.candidates.block[rank].assign(columns, 0);
    state->scratch.candidates.value[rank].assign(columns, 0);
    state->evidence[rank].assign(columns, {});
  }
  state->scratch.candidates.seen_count.assign(columns, 0);
  // The instruction set is chosen here and not at the first frame.
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  return PeakExtractor{std::move(state)};
}

}  // namespace biteline::stripe
