// SPDX-License-Identifier: MIT
// Candidates looked at closely: where exactly, how wide, how sure.  Neighbouring columns whose candidates lie
// near each other are fitted together.  Compiled once per instruction set, chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/stripe/fit_peak_rt.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "common/stripe/fit_shape-inl.hpp"
#include "common/stripe/peak_extractor_state.hpp"

#ifndef BITELINE_STRIPE_FITTER_CONSTANTS
#define BITELINE_STRIPE_FITTER_CONSTANTS
namespace biteline::stripe {
/// Columns whose candidates are farther apart than this are not walked together.
inline constexpr int k_max_spread_rows = 32;
/// Rows on either side of the candidate's block that the start values look at: wider stripes are seen in
/// part, and their width grows in the rounds.
inline constexpr float k_start_rows = 8;
/// One weighted round always, and up to so many more until all columns have settled.
inline constexpr int k_more_rounds = 3;
/// Speckle that the weights believe in.  Full belief would give the far tails as much say as the top, and
/// there the shape is not known that well.  On made stripes under the speckle of a round pupil at contrasts
/// of 0.27 and 0.47 weights of 0.3 have a fifth less noise; on photographs they follow the light's own halo,
/// and a third more of good columns is taken for cut by print.
inline constexpr float k_weight_contrast = 0.06F;
}  // namespace biteline::stripe
#endif

HWY_BEFORE_NAMESPACE();
namespace biteline::stripe {
namespace HWY_NAMESPACE {

/// Neighbouring columns whose candidates are fitted together.
struct Group {
  std::size_t first_column;
  M used;
  V block_row;   ///< first row of the candidate's block; unused lanes repeat a used one's
  V top;         ///< the block's maximum
  V background;  ///< the column's quiet level
};

HWY_INLINE float lowest(V v, M used) {
  return hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(used, v, hn::Set(d, 1e6F))));
}
HWY_INLINE float highest(V v, M used) {
  return hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(used, v, hn::Set(d, -1e6F))));
}

/// Rows that hold those from `low` to `high` of every used lane.
HWY_INLINE Walk walk_over(const FrameRows& frame, const Group& group, V low, V high) {
  const int first = std::clamp(static_cast<int>(lowest(low, group.used)), 0, frame.height_px - 1);
  const int last = std::clamp(static_cast<int>(highest(high, group.used)) + 1, first, frame.height_px - 1);
  return {.pixels = frame.pixels + static_cast<std::size_t>(first) * frame.stride_bytes + group.first_column,
          .stride_bytes = frame.stride_bytes,
          .first_row = first,
          .row_count = last - first + 1};
}

struct Fit {
  Stripe stripe;
  Round last;
};

/// PeakFlag of each lane, as numbers, but for k_peak_poor_fit.
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> flags_of(const Fit& fit, const Group& group,
                                                   const PeakConfig& config, int height_px) {
  const hn::RebindToSigned<D> di;
  const V width_px = hn::Mul(fit.stripe.sigma, hn::Set(d, k_fwhm_per_sigma));
  // Cut where it still has a tenth of its height: exp(-2.15^2 / 2).
  const V tenth = hn::Mul(fit.stripe.sigma, hn::Set(d, 2.15F));
  const M clipped =
      hn::Or(hn::Lt(hn::Sub(fit.stripe.centre, tenth), hn::Zero(d)),
             hn::Gt(hn::Add(fit.stripe.centre, tenth), hn::Set(d, static_cast<float>(height_px - 1))));
  const auto flag = [&](M lanes, PeakFlag value) {
    return hn::IfThenElseZero(hn::RebindMask(di, lanes), hn::Set(di, value));
  };
  auto flags = hn::Or(flag(hn::Gt(group.top, hn::Set(d, k_below_full)), k_peak_saturated),
                      flag(clipped, k_peak_clipped));
  flags = hn::Or(flags, flag(hn::Gt(width_px, hn::Set(d, config.width_max_px)), k_peak_wide));
  return hn::Or(flags, flag(hn::Lt(width_px, hn::Set(d, config.width_min_px)), k_peak_narrow));
}

/// A vector's lanes, to be read one by one.
struct alignas(64) Lanes {
  std::array<float, k_max_lanes> at;
  HWY_INLINE explicit Lanes(V value) { hn::Store(value, d, at.data()); }
};

/// Adds the group's peaks to their columns; those whose amplitude is too low are dropped.
void write_peaks(const Fit& fit, const Group& group, const PeakConfig& config, int height_px,
                 Evidence& evidence, Peaks& out) {
  const hn::RebindToSigned<D> di;
  const FitEvidenceOf<V>& known = fit.last.evidence;
  const Lanes row_px{fit.stripe.centre}, amplitude{fit.stripe.amplitude},
      width_px{hn::Mul(fit.stripe.sigma, hn::Set(d, k_fwhm_per_sigma))}, background{fit.stripe.background},
      skew{fit.last.skew}, misfit{known.misfit}, centre_variance{known.centre_variance},
      centre_gain{known.centre_gain}, light_variance{known.light_variance}, light_gain{known.light_gain},
      light_per_width{known.light_per_width};
  alignas(64) std::array<std::int32_t, k_max_lanes> flags;
  hn::Store(flags_of(fit, group, config, height_px), di, flags.data());
  const M high = hn::And(group.used, hn::Ge(fit.stripe.amplitude, hn::Set(d, config.threshold_grey)));
  const Lanes kept{hn::IfThenElseZero(high, hn::Set(d, 1.0F))};
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    if (kept.at[lane] == 0) continue;
    ColumnPeaks& column = out.columns[group.first_column + lane];
    evidence[column.kept_count][group.first_column + lane] = {.misfit = misfit.at[lane],
                                                              .centre_variance = centre_variance.at[lane],
                                                              .centre_gain = centre_gain.at[lane],
                                                              .light_variance = light_variance.at[lane],
                                                              .light_gain = light_gain.at[lane],
                                                              .light_per_width = light_per_width.at[lane]};
    column.kept[column.kept_count++] = {.row_px = row_px.at[lane],
                                        .amplitude = amplitude.at[lane],
                                        .width_px = width_px.at[lane],
                                        .background = background.at[lane],
                                        .skew = skew.at[lane],
                                        .flags = static_cast<std::uint8_t>(flags[lane])};
  }
}

/// The rows about the candidates of the next cache line of columns: they left the near caches when the frame
/// streamed by, if they were read at all.
void prefetch_lane(const FrameRows& frame, const CoarseScratch& scratch, std::size_t rank,
                   std::size_t first_column) {
  const auto width = static_cast<std::size_t>(frame.width_px);
  if (first_column >= width) return;
  const std::size_t last_column = std::min(first_column + k_lane_columns, width) - 1;
  if (scratch.candidates.seen_count[first_column] <= rank ||
      scratch.candidates.seen_count[last_column] <= rank)
    return;
  // As the walks go: a block more on either side, and no farther than columns are walked together.
  const auto [low, high] = std::minmax(
      {int{scratch.candidates.block[rank][first_column]}, int{scratch.candidates.block[rank][last_column]}});
  const int first_row = std::max(0, (low - 1) * k_block_rows);
  const int end_row =
      std::min({frame.height_px, (high + 2) * k_block_rows, first_row + 2 * k_max_spread_rows});
  for (int row = first_row; row < end_row; ++row) {
    hwy::Prefetch(frame.pixels + static_cast<std::size_t>(row) * frame.stride_bytes + first_column);
  }
}

/// Fits groups some at a time, step by step: the long chain of results at the end of one group's step is
/// worked off while the next group's rows are walked.
class Fitter {
 public:
  Fitter(const FrameRows& frame, const PeakConfig& config, const FitWeights& weights, Evidence& evidence,
         Peaks& out)
      : frame_{frame}, config_{config}, weights_{weights}, evidence_{evidence}, out_{out} {}

  HWY_INLINE void add(const Group& group) {
    groups_[count_++] = group;
    if (count_ == k_together) finish();
  }

  /// Fits what waits, and adds its peaks to their columns.
  void finish() {
    for (std::size_t i = 0; i < count_; ++i) start(groups_[i], fits_[i]);
    for (std::size_t i = 0; i < count_; ++i) {
      Stripe& stripe = fits_[i].stripe;
      improve<false>(reach(groups_[i], stripe, hn::Mul(stripe.sigma, hn::Set(d, k_reach_sigma))), weights_,
                     stripe);
    }
    std::array<bool, k_together> settled{};
    for (int round = 0; round <= k_more_rounds; ++round) {
      for (std::size_t i = 0; i < count_; ++i) {
        if (!settled[i]) step(groups_[i], fits_[i]);
      }
      for (std::size_t i = 0; i < count_; ++i)
        settled[i] = hn::AllTrue(d, hn::Or(fits_[i].last.settled, hn::Not(groups_[i].used)));
    }
    for (std::size_t i = 0; i < count_; ++i)
      write_peaks(fits_[i], groups_[i], config_, frame_.height_px, evidence_, out_);
    count_ = 0;
  }

 private:
  HWY_INLINE Walk reach(const Group& group, const Stripe& stripe, V distance) const {
    return walk_over(frame_, group, hn::Sub(stripe.centre, distance), hn::Add(stripe.centre, distance));
  }

  /// Looks at the block and some rows on either side.
  HWY_INLINE void start(const Group& group, Fit& fit) const {
    const V middle = hn::Add(group.block_row, hn::Set(d, 0.5F * (k_block_rows - 1)));
    const V half = hn::Set(d, 0.5F * (k_block_rows - 1) + k_start_rows);
    const Walk walk = walk_over(frame_, group, hn::Sub(middle, half), hn::Add(middle, half));
    fit.stripe = start_values(walk, middle, half, group.top, group.background);
  }

  HWY_INLINE void step(const Group& group, Fit& fit) const {
    Stripe& stripe = fit.stripe;
    const V inner = hn::Mul(stripe.sigma, hn::Set(d, k_reach_sigma));
    const V outer =
        hn::Max(hn::Mul(stripe.sigma, hn::Set(d, k_background_sigma)), hn::Add(inner, hn::Set(d, 2.0F)));
    const Walk within = reach(group, stripe, inner);
    const Walk before =
        walk_over(frame_, group, hn::Sub(stripe.centre, outer), hn::Sub(stripe.centre, inner));
    const Walk after = walk_over(frame_, group, hn::Add(stripe.centre, inner), hn::Add(stripe.centre, outer));
    set_background(side_level(before, stripe.centre, -1, inner, outer),
                   side_level(after, stripe.centre, 1, inner, outer), inner, outer, stripe);
    fit.last = improve<true>(within, weights_, stripe);
  }

  static constexpr std::size_t k_together = 4;
  const FrameRows& frame_;
  const PeakConfig& config_;
  FitWeights weights_;
  Evidence& evidence_;
  Peaks& out_;
  std::size_t count_{0};
  Group groups_[k_together];
  Fit fits_[k_together];
};

/// The candidates of one rank in one vector of columns, those from `first_new` on: as many groups as they lie
/// apart.
HWY_INLINE void add_columns(const CoarseScratch& scratch, std::size_t rank, std::size_t first_column,
                            std::size_t first_new, Fitter& fitter) {
  const Candidates& candidates = scratch.candidates;
  const V column = hn::Iota(d, static_cast<float>(first_column));
  M waiting = hn::And(
      hn::Gt(load_grey(candidates.seen_count.data() + first_column), hn::Set(d, static_cast<float>(rank))),
      hn::Ge(column, hn::Set(d, static_cast<float>(first_new))));
  const V block_row = hn::Mul(load_grey(candidates.block[rank].data() + first_column),
                              hn::Set(d, static_cast<float>(k_block_rows)));
  const V top = load_grey(candidates.value[rank].data() + first_column);
  const V background = load_grey(scratch.background.data() + first_column);
  while (!hn::AllFalse(d, waiting)) {
    // From the highest one down as far as columns are walked together.
    const V first = hn::Set(d, lowest(block_row, waiting));
    const M used = hn::And(
        waiting, hn::Le(hn::Sub(block_row, first), hn::Set(d, static_cast<float>(k_max_spread_rows))));
    fitter.add({.first_column = first_column,
                .used = used,
                .block_row = hn::IfThenElse(used, block_row, first),
                .top = hn::IfThenElse(used, top, hn::Set(d, 255.0F)),
                .background = background});
    waiting = hn::AndNot(used, waiting);
  }
}

void fit_all(const FrameRows& frame, const PeakConfig& config, const FitWeights& weights,
             const CoarseScratch& scratch, Evidence& evidence, Peaks& out) {
  const auto width = static_cast<std::size_t>(frame.width_px);
  const std::size_t lanes = hn::Lanes(d);
  Fitter fitter{frame, config, weights, evidence, out};
  for (std::size_t rank = 0; rank < k_kept_peaks; ++rank) {
    for (std::size_t start = 0; start < width; start += lanes) {
      if (start % k_lane_columns == 0) prefetch_lane(frame, scratch, rank, start + k_lane_columns);
      // The last vector is moved back to end with the row; its first lanes were done already.
      add_columns(scratch, rank, std::min(start, width - lanes), start, fitter);
    }
    fitter.finish();
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::stripe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::stripe {
namespace {

HWY_EXPORT(fit_all);

}  // namespace

void rt_fit_candidates(const FrameRows& frame, const PeakConfig& config, const CoarseScratch& scratch,
                       Evidence& evidence, Peaks& out) noexcept BITELINE_RT {
  const NoiseModel& noise = config.noise;
  const FitWeights weights{.read_variance_grey2 = noise.read_noise_grey * noise.read_noise_grey,
                           .gain_grey = noise.gain_grey_per_electron,
                           .contrast = std::min(noise.speckle_contrast, k_weight_contrast)};
  HWY_DYNAMIC_DISPATCH(fit_all)(frame, config, weights, scratch, evidence, out);
}

}  // namespace biteline::stripe
#endif  // HWY_ONCE
