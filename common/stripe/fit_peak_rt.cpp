// SPDX-License-Identifier: MIT
// Candidates looked at closely: where exactly, how wide, how sure.  A vector holds neighbouring columns, one
// per lane; the rows around their stripes are walked once per step and read as rows, so that no gather is
// needed.  Compiled once per instruction set, chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/stripe/fit_peak_rt.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "common/stripe/peak_extractor_state.hpp"

#ifndef BITELINE_STRIPE_FIT_CONSTANTS
#define BITELINE_STRIPE_FIT_CONSTANTS
namespace biteline::stripe {
/// FWHM of a Gaussian over its standard deviation: 2 sqrt(2 ln 2).
inline constexpr float k_fwhm_per_sigma = 2.3548F;
/// A Gaussian's tail beyond this many standard deviations is below 1 % of the height.
inline constexpr float k_reach_sigma = 3.2F;
/// Beyond the tail and up to here the background is read.
inline constexpr float k_background_sigma = 4.8F;
/// Narrower than a pixel's own aperture cannot be, wider than this is no stripe.
inline constexpr float k_min_sigma_px = 0.5F, k_max_sigma_px = 16.0F;
/// Columns whose candidates are farther apart than this are not walked together.
inline constexpr int k_max_spread_rows = 32;
/// Speckle that the weights believe in.  Full belief would give the far tails as much say as the top, and
/// there the shape is not known that well: the fit would follow its own width estimate (worse than this from
/// contrast 0.15 on, see bench_stripe_accuracy).  The variance that is reported holds all of the speckle.
inline constexpr float k_weight_contrast = 0.06F;
/// Two rounds always, and up to so many more until no lane's centre moves by most of its standard deviation:
/// what is left after such a step is a tenth of it.
inline constexpr int k_more_rounds = 3;
inline constexpr float k_settled_step_squared = 1.0F;
/// The residual over the model's own energy, above which the shape is no stripe's: this, and as much again as
/// the speckle makes of itself.  Two stripes four of their standard deviations apart reach 0.4.
inline constexpr float k_poor_fit_ratio = 0.22F;
}  // namespace biteline::stripe
#endif

HWY_BEFORE_NAMESPACE();
namespace biteline::stripe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, k_max_lanes>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr D d{};

/// exp(-x) for 0 <= x <= 12, to 2 % of itself and 0.0002 of one: ten times what a real stripe keeps to its
/// shape.
HWY_INLINE V falling_exponential(V x) {
  const V t = hn::Mul(x, hn::Set(d, -1.0F / 32));
  V e = hn::MulAdd(t, hn::MulAdd(t, hn::Set(d, 0.5F), hn::Set(d, 1.0F)), hn::Set(d, 1.0F));
  for (int i = 0; i < 5; ++i) e = hn::Mul(e, e);
  return e;
}

/// The stripes of one vector of columns.
struct Stripe {
  V centre;  ///< row, from the walk's first
  V sigma;
  V amplitude;
  V background;  ///< at the centre
  V tilt;        ///< background's change per row
};

/// Rows [first, last] of neighbouring columns.
struct Walk {
  const std::uint8_t* pixels;  ///< first row, first column
  std::size_t stride_bytes;
  int row_count;

  HWY_INLINE V row(int i) const {
    const hn::Rebind<std::uint8_t, D> d8;
    const hn::Rebind<std::int32_t, D> d32;
    return hn::ConvertTo(
        d, hn::PromoteTo(d32, hn::LoadU(d8, pixels + static_cast<std::size_t>(i) * stride_bytes)));
  }
};

/// Start values: mean row and number of the pixels above half height, around the candidate's block.
HWY_INLINE Stripe start_values(const Walk& walk, V first_of_window, V last_of_window, V top, V background) {
  const V half = hn::Mul(hn::Add(top, background), hn::Set(d, 0.5F)), zero = hn::Zero(d),
          one = hn::Set(d, 1.0F);
  V count = zero, sum = zero, height = zero;
  V row = zero;
  for (int i = 0; i < walk.row_count; ++i) {
    const V above = hn::Sub(walk.row(i), half);
    const M inside =
        hn::And(hn::And(hn::Ge(row, first_of_window), hn::Le(row, last_of_window)), hn::Ge(above, zero));
    const V unit = hn::IfThenElseZero(inside, one);
    count = hn::Add(count, unit);
    sum = hn::MulAdd(unit, row, sum);
    height = hn::Add(height, hn::IfThenElseZero(inside, above));
    row = hn::Add(row, one);
  }
  count = hn::Max(count, one);
  // A Gaussian's mean over its upper half is 0.81 of its top; the brightest pixel itself is mostly speckle.
  const V mean_height = hn::Add(hn::Div(height, count), hn::Sub(half, background));
  return {.centre = hn::Div(sum, count),
          .sigma = hn::Max(hn::Mul(count, hn::Set(d, 1 / k_fwhm_per_sigma)), hn::Set(d, 0.8F)),
          .amplitude = hn::Mul(mean_height, hn::Set(d, 1 / 0.81F)),
          .background = background,
          .tilt = zero};
}

/// Mean grey on either side of the stripe; a side that is cut off or holds another stripe takes the other's.
HWY_INLINE void read_background(const Walk& walk, Stripe& stripe) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const V inner = hn::Mul(stripe.sigma, hn::Set(d, k_reach_sigma));
  const V outer =
      hn::Max(hn::Mul(stripe.sigma, hn::Set(d, k_background_sigma)), hn::Add(inner, hn::Set(d, 2.0F)));
  V before_sum = zero, before_count = zero, after_sum = zero, after_count = zero;
  V x = hn::Neg(stripe.centre);
  for (int i = 0; i < walk.row_count; ++i) {
    const V grey = walk.row(i), distance = hn::Abs(x);
    const M edge = hn::And(hn::Gt(distance, inner), hn::Le(distance, outer));
    const M before = hn::And(edge, hn::Lt(x, zero)), after = hn::And(edge, hn::Ge(x, zero));
    before_sum = hn::Add(before_sum, hn::IfThenElseZero(before, grey));
    before_count = hn::Add(before_count, hn::IfThenElseZero(before, one));
    after_sum = hn::Add(after_sum, hn::IfThenElseZero(after, grey));
    after_count = hn::Add(after_count, hn::IfThenElseZero(after, one));
    x = hn::Add(x, one);
  }
  V before = hn::Div(before_sum, hn::Max(before_count, one)),
    after = hn::Div(after_sum, hn::Max(after_count, one));
  const M no_before = hn::Lt(before_count, hn::Set(d, 1.5F)),
          no_after = hn::Lt(after_count, hn::Set(d, 1.5F));
  before = hn::IfThenElse(no_before, after, before);
  after = hn::IfThenElse(no_after, before, after);
  // A difference of a fifth of the height is another stripe and not a tilted background.
  const V limit = hn::Mul(hn::Max(stripe.amplitude, one), hn::Set(d, 0.2F));
  const V low = hn::Min(before, after);
  const M other = hn::Gt(hn::Abs(hn::Sub(before, after)), limit);
  before = hn::IfThenElse(other, low, before);
  after = hn::IfThenElse(other, low, after);
  const M nothing = hn::And(no_before, no_after);
  stripe.background =
      hn::IfThenElse(nothing, stripe.background, hn::Mul(hn::Add(before, after), hn::Set(d, 0.5F)));
  stripe.tilt = hn::IfThenElse(nothing, zero, hn::Div(hn::Sub(after, before), hn::Add(inner, outer)));
}

/// What one round of the fit learns.
struct Round {
  V variance_centre;  ///< of the new centre, by the noise model
  V misfit;           ///< residual's share of the model's energy
  V saturated;        ///< pixels at full scale within the stripe
  M settled;          ///< the last step was small against the standard deviation
};

/// `Judge` also fills Round's misfit and saturated, and counts all of the speckle in the variance.
///
/// One Gauss-Newton step of the weighted least-squares fit of a Gaussian on a tilted background.  The weights
/// are one over the noise model's variance at the current estimate, which makes the fit's limit the
/// maximum-likelihood estimate to first order (Kay 1993, Fundamentals of Statistical Signal Processing, ch.
/// 7), but for strong speckle.  Centre on one side and amplitude and width on the other are even and odd
/// about the centre, so their cross terms vanish but for the sampling, and the system splits into 1 + 2.
/// Saturated pixels carry no weight: they only say "at least this".
template <bool Judge>
HWY_INLINE Round improve(const Walk& walk, const NoiseModel& noise, Stripe& stripe) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const V read_variance = hn::Set(d, noise.read_noise_grey * noise.read_noise_grey);
  const V gain = hn::Set(d, noise.gain_grey_per_electron);
  const float weight_contrast = std::min(noise.speckle_contrast, k_weight_contrast);
  const V speckle = hn::Set(d, weight_contrast * weight_contrast);
  const V per_sigma = hn::Div(one, stripe.sigma);
  const V full_scale = hn::Set(d, 254.5F), reach_squared = hn::Set(d, k_reach_sigma * k_reach_sigma);
  const V base_variance = hn::MulAdd(gain, hn::Max(stripe.background, zero), read_variance);

  // Sums over the rows with g = exp(-u^2 / 2), weight w and residual r: of w g^2 u^k, and of w g r u^k.
  V gg0 = zero, gg2 = zero, gg4 = zero, gr0 = zero, gr1 = zero, gr2 = zero;
  V speckled = zero, energy = zero, residual_energy = zero, saturated = zero;
  V x = hn::Neg(stripe.centre);
  for (int i = 0; i < walk.row_count; ++i) {
    const V grey = walk.row(i);
    const V u = hn::Mul(x, per_sigma), u2 = hn::Mul(u, u);
    const M inside = hn::Lt(u2, reach_squared), full = hn::Gt(grey, full_scale),
            used = hn::AndNot(full, inside);
    const V g = falling_exponential(hn::Min(hn::Mul(u2, hn::Set(d, 0.5F)), hn::Set(d, 12.0F)));
    const V mean = hn::Mul(stripe.amplitude, g);
    const V variance = hn::MulAdd(mean, hn::MulAdd(mean, speckle, gain), base_variance);
    const V weighted = hn::IfThenElseZero(used, hn::Mul(hn::ApproximateReciprocal(variance), g));
    const V residual = hn::Sub(grey, hn::MulAdd(x, stripe.tilt, hn::Add(stripe.background, mean)));
    const V gg = hn::Mul(weighted, g), ggu2 = hn::Mul(gg, u2), gr = hn::Mul(weighted, residual),
            gru = hn::Mul(gr, u);
    gg0 = hn::Add(gg0, gg);
    gg2 = hn::Add(gg2, ggu2);
    gg4 = hn::MulAdd(ggu2, u2, gg4);
    gr0 = hn::Add(gr0, gr);
    gr1 = hn::Add(gr1, gru);
    gr2 = hn::MulAdd(gru, u, gr2);
    if constexpr (Judge) {
      speckled = hn::MulAdd(hn::Mul(gg, u), hn::Mul(gg, u), speckled);
      const V counted = hn::IfThenElseZero(used, mean), counted_residual = hn::IfThenElseZero(used, residual);
      energy = hn::MulAdd(counted, mean, energy);
      residual_energy = hn::MulAdd(counted_residual, residual, residual_energy);
      saturated = hn::Add(saturated, hn::IfThenElseZero(hn::And(full, inside), one));
    }
    x = hn::Add(x, one);
  }
  const V tiny = hn::Set(d, 1e-12F);
  gg2 = hn::Max(gg2, tiny);
  const V amplitude_per_sigma = hn::Mul(stripe.amplitude, per_sigma);
  const V information = hn::Mul(hn::Mul(amplitude_per_sigma, amplitude_per_sigma), gg2);  // on the centre
  const V step = hn::Div(gr1, hn::Mul(amplitude_per_sigma, gg2));
  const V determinant = hn::Max(hn::NegMulAdd(gg2, gg2, hn::Mul(gg0, gg4)), tiny);
  const V step_amplitude = hn::Div(hn::NegMulAdd(gg2, gr2, hn::Mul(gg4, gr0)), determinant);
  const V step_sigma =
      hn::Div(hn::NegMulAdd(gg2, gr0, hn::Mul(gg0, gr2)), hn::Mul(determinant, amplitude_per_sigma));
  const auto within = [](V value, V low, V high) { return hn::Max(low, hn::Min(value, high)); };
  stripe.centre = hn::Add(stripe.centre, within(step, hn::Neg(stripe.sigma), stripe.sigma));
  stripe.amplitude =
      within(hn::Add(stripe.amplitude, step_amplitude), hn::Mul(stripe.amplitude, hn::Set(d, 0.5F)),
             hn::Mul(stripe.amplitude, hn::Set(d, 2.0F)));
  stripe.sigma = within(hn::Add(stripe.sigma, step_sigma), hn::Mul(stripe.sigma, hn::Set(d, 0.7F)),
                        hn::Mul(stripe.sigma, hn::Set(d, 1.5F)));
  stripe.sigma = hn::Max(hn::Set(d, k_min_sigma_px), hn::Min(stripe.sigma, hn::Set(d, k_max_sigma_px)));
  // Neighbouring rows share their speckle: its part of the variance counts as many times as rows go together.
  const V amplitude_squared = hn::Mul(stripe.amplitude, stripe.amplitude);
  const V extra =
      hn::Mul(hn::Div(hn::Mul(hn::Mul(speckled, amplitude_squared), amplitude_squared),
                      hn::Mul(stripe.sigma, stripe.sigma)),
              hn::Set(d, noise.speckle_contrast * noise.speckle_contrast * noise.speckle_grain_px -
                             weight_contrast * weight_contrast));
  // The fit's own height and width follow the speckle; to second order that adds four times its square (seen
  // in bench_stripe_accuracy at contrasts from 0.1 to 0.3).
  const V second_order = hn::Set(d, 1 + 4 * noise.speckle_contrast * noise.speckle_contrast);
  return {.variance_centre =
              hn::Mul(hn::Div(hn::Add(one, hn::Div(extra, information)), information), second_order),
          .misfit = hn::Sqrt(hn::Div(residual_energy, hn::Max(energy, one))),
          .saturated = saturated,
          .settled = hn::Lt(hn::Mul(hn::Mul(step, step), information), hn::Set(d, k_settled_step_squared))};
}

/// Rows that cover `reach` standard deviations of every used lane's stripe.
HWY_INLINE Walk walk_around(const FrameRows& frame, const FitGroup& group, const Walk& previous,
                            const Stripe& stripe, float reach_sigma, int& first_row) {
  const M used = hn::Ne(hn::LoadU(d, group.in_use.data()), hn::Zero(d));
  const V reach = hn::MulAdd(stripe.sigma, hn::Set(d, reach_sigma), hn::Set(d, 2.0F)), far = hn::Set(d, 1e6F);
  const float low = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(used, hn::Sub(stripe.centre, reach), far)));
  const float high =
      hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(used, hn::Add(stripe.centre, reach), hn::Neg(far))));
  const int first = std::clamp(first_row + static_cast<int>(low), 0, frame.height_px - 1);
  const int last = std::clamp(first_row + static_cast<int>(high) + 1, first, frame.height_px - 1);
  const Walk walk{
      .pixels = previous.pixels + (first - first_row) * static_cast<std::ptrdiff_t>(frame.stride_bytes),
      .stride_bytes = frame.stride_bytes,
      .row_count = last - first + 1};
  first_row = first;
  return walk;
}

/// Moves the stripe's rows to a walk that begins `rows` later.
HWY_INLINE void rebase(Stripe& stripe, int rows) {
  stripe.centre = hn::Sub(stripe.centre, hn::Set(d, static_cast<float>(rows)));
}

void fit_group(const FrameRows& frame, const FitGroup& group, const NoiseModel& noise, FittedLanes& out) {
  // The start looks at the block and as many rows on either side: the widest stripe, however it lies.
  constexpr int k_window_rows = 8;
  int first = std::max(0, group.lowest_row - k_window_rows);
  const int last = std::min(frame.height_px - 1, group.highest_row + k_block_rows - 1 + k_window_rows);
  Walk walk{
      .pixels = frame.pixels + static_cast<std::size_t>(first) * frame.stride_bytes + group.first_column,
      .stride_bytes = frame.stride_bytes,
      .row_count = last - first + 1};
  const V block_row = hn::Sub(hn::LoadU(d, group.block_row.data()), hn::Set(d, static_cast<float>(first)));
  Stripe stripe =
      start_values(walk, hn::Sub(block_row, hn::Set(d, static_cast<float>(k_window_rows))),
                   hn::Add(block_row, hn::Set(d, static_cast<float>(k_block_rows - 1 + k_window_rows))),
                   hn::LoadU(d, group.top.data()), hn::LoadU(d, group.background.data()));

  const int start_first = first;
  walk = walk_around(frame, group, walk, stripe, k_background_sigma, first);
  rebase(stripe, first - start_first);
  improve<false>(walk, noise, stripe);
  read_background(walk, stripe);
  const int wide_first = first;
  walk = walk_around(frame, group, walk, stripe, k_reach_sigma, first);
  rebase(stripe, first - wide_first);
  Round round = improve<true>(walk, noise, stripe);
  const M used = hn::Ne(hn::LoadU(d, group.in_use.data()), hn::Zero(d));
  for (int more = 0; more < k_more_rounds && !hn::AllTrue(d, hn::Or(round.settled, hn::Not(used))); ++more) {
    round = improve<true>(walk, noise, stripe);
  }

  hn::StoreU(hn::Add(stripe.centre, hn::Set(d, static_cast<float>(first))), d, out.centre.data());
  hn::StoreU(stripe.sigma, d, out.sigma.data());
  hn::StoreU(stripe.amplitude, d, out.amplitude.data());
  hn::StoreU(stripe.background, d, out.background.data());
  hn::StoreU(hn::Sqrt(round.variance_centre), d, out.sigma_centre.data());
  hn::StoreU(round.misfit, d, out.misfit.data());
  hn::StoreU(round.saturated, d, out.saturated.data());
}

std::size_t fit_lanes() {
  return hn::Lanes(d);
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::stripe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::stripe {
namespace {

HWY_EXPORT(fit_group);
HWY_EXPORT(fit_lanes);

std::uint8_t flags_of(const FittedLanes& fitted, std::size_t lane, const PeakConfig& config, int height_px) {
  const float centre = fitted.centre[lane], sigma = fitted.sigma[lane], width_px = sigma * k_fwhm_per_sigma;
  std::uint8_t flags = 0;
  if (fitted.saturated[lane] > 0.5F) flags |= k_peak_saturated;
  // Cut where it still has a tenth of its height: exp(-2.15^2 / 2).
  if (centre - 2.15F * sigma < 0 || centre + 2.15F * sigma > static_cast<float>(height_px - 1))
    flags |= k_peak_clipped;
  if (width_px > config.width_max_px) flags |= k_peak_wide;
  if (width_px < config.width_min_px) flags |= k_peak_narrow;
  if (fitted.misfit[lane] > k_poor_fit_ratio + 1.1F * config.noise.speckle_contrast) flags |= k_peak_poor_fit;
  return flags;
}

/// The lanes from `first_lane` on whose candidates lie near the first used one; takes them out of `waiting`.
void gather(const CoarseScratch& scratch, std::size_t lanes, std::size_t rank,
            std::array<bool, k_max_lanes>& waiting, std::size_t first_lane, FitGroup& group) {
  const auto row_of = [&](std::size_t lane) {
    return scratch.candidates[group.first_column + lane].kept[rank].block * k_block_rows;
  };
  group.lowest_row = group.highest_row = row_of(first_lane);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    group.used[lane] = false;
    const std::size_t column = group.first_column + lane;
    // Unused lanes repeat the first one's rows: their results are thrown away.
    int row = row_of(first_lane);
    if (lane >= first_lane && waiting[lane]) {
      const int low = std::min(group.lowest_row, row_of(lane)),
                high = std::max(group.highest_row, row_of(lane));
      if (high - low <= k_max_spread_rows) {
        group.lowest_row = low;
        group.highest_row = high;
        row = row_of(lane);
        group.used[lane] = true;
        waiting[lane] = false;
      }
    }
    group.block_row[lane] = static_cast<float>(row);
    group.in_use[lane] = group.used[lane] ? 1.0F : 0.0F;
    group.top[lane] =
        group.used[lane] ? static_cast<float>(scratch.candidates[column].kept[rank].value) : 255.0F;
    group.background[lane] = static_cast<float>(scratch.background[column]);
  }
}

/// The rows about the candidates of the next cache line of columns: they left the near caches when the frame
/// streamed by.
void prefetch_lane(const FrameRows& frame, const CoarseScratch& scratch, std::size_t rank,
                   std::size_t first_column) {
  const auto width = static_cast<std::size_t>(frame.width_px);
  if (first_column >= width) return;
  const ColumnCandidates& first = scratch.candidates[first_column];
  const ColumnCandidates& last = scratch.candidates[std::min(first_column + k_lane_columns, width) - 1];
  if (first.kept_count <= rank || last.kept_count <= rank) return;
  // As the walks go: a block more on either side, and no farther than columns are walked together.
  const auto [low, high] = std::minmax(first.kept[rank].block, last.kept[rank].block);
  const int first_row = std::max(0, (low - 1) * k_block_rows);
  const int end_row =
      std::min({frame.height_px, (high + 2) * k_block_rows, first_row + 2 * k_max_spread_rows});
  for (int row = first_row; row < end_row; ++row) {
    hwy::Prefetch(frame.pixels + static_cast<std::size_t>(row) * frame.stride_bytes + first_column);
  }
}

}  // namespace

void rt_fit_candidates(const FrameRows& frame, const PeakConfig& config, const CoarseScratch& scratch,
                       Peaks& out) noexcept BITELINE_RT {
  const std::size_t lanes = HWY_DYNAMIC_DISPATCH(fit_lanes)();
  const auto width = static_cast<std::size_t>(frame.width_px);
  FitGroup group{};
  FittedLanes fitted{};
  for (std::size_t rank = 0; rank < k_kept_peaks; ++rank) {
    for (std::size_t start = 0; start < width; start += lanes) {
      if (start % k_lane_columns == 0) prefetch_lane(frame, scratch, rank, start + k_lane_columns);
      // The last vector is moved back to end with the row; its first lanes were done already.
      group.first_column = std::min(start, width - lanes);
      std::array<bool, k_max_lanes> waiting{};
      bool any = false;
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t column = group.first_column + lane;
        waiting[lane] = column >= start && scratch.candidates[column].kept_count > rank;
        any = any || waiting[lane];
      }
      if (!any) continue;
      for (std::size_t first_lane = 0; first_lane < lanes; ++first_lane) {
        if (!waiting[first_lane]) continue;
        gather(scratch, lanes, rank, waiting, first_lane, group);
        HWY_DYNAMIC_DISPATCH(fit_group)(frame, group, config.noise, fitted);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          if (!group.used[lane] || fitted.amplitude[lane] < config.threshold_grey) continue;
          ColumnPeaks& column = out.columns[group.first_column + lane];
          column.kept[column.kept_count++] = {.row_px = fitted.centre[lane],
                                              .sigma_row_px = fitted.sigma_centre[lane],
                                              .amplitude = fitted.amplitude[lane],
                                              .width_px = fitted.sigma[lane] * k_fwhm_per_sigma,
                                              .background = fitted.background[lane],
                                              .flags = flags_of(fitted, lane, config, frame.height_px)};
        }
      }
    }
  }
}

}  // namespace biteline::stripe
#endif  // HWY_ONCE
