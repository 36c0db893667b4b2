// SPDX-License-Identifier: MIT
/// \file The stripe's shape fitted to one vector of columns: start values, background, Gauss-Newton steps.  A
/// vector holds neighbouring columns, one per lane, whose rows are walked together and read as rows, so that
/// no gather is needed.  Included once per instruction set, by fit_peak_rt.cpp alone.
#include <hwy/highway.h>

#include <algorithm>

#include "common/stripe/peak_extractor_state.hpp"

#ifndef BITELINE_STRIPE_FIT_CONSTANTS
#define BITELINE_STRIPE_FIT_CONSTANTS
namespace biteline::stripe {
/// FWHM of a Gaussian over its standard deviation: 2 sqrt(2 ln 2).
inline constexpr float k_fwhm_per_sigma = 2.3548F;
/// Grey values above this are at full scale.
inline constexpr float k_below_full = 254.5F;
/// A Gaussian's tail beyond this many standard deviations is below 1 % of the height.
inline constexpr float k_reach_sigma = 3.2F;
/// Beyond the tail and up to here the background is read.
inline constexpr float k_background_sigma = 4.8F;
/// Narrower than a pixel's own aperture cannot be, wider than this is no stripe.
inline constexpr float k_min_sigma_px = 0.5F, k_max_sigma_px = 16.0F;
/// Where the start values cut: low enough to see most of the stripe's light, high enough to leave out
/// another's.
inline constexpr float k_cut_ratio = 0.4F;
/// A column has settled when a further round would change little.  A Gauss-Newton step leaves an error of the
/// order of the step times the relative changes of height, width and place: the square of that over the
/// centre's variance.
inline constexpr float k_settled_ratio = 0.08F;
/// Relative changes above this are worth another round in any case: height, width and misfit are then off,
/// too.
inline constexpr float k_settled_change = 0.25F;
/// What the weights took for speckle is taken off a variance again, but not more than leaves this share.
inline constexpr float k_least_noise_ratio = 0.05F;
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

/// exp(-8 v2) for 0 <= v2 <= 1.5, to 0.2 % where it is above 0.1 and to 0.0006 of one below: less than a real
/// stripe keeps to its shape.
HWY_INLINE V gaussian(V v2) {
  const V one = hn::Set(d, 1.0F);
  V e = hn::NegMulAdd(v2, hn::NegMulAdd(v2, hn::NegMulAdd(v2, hn::Set(d, 1.0F / 6), hn::Set(d, 0.5F)), one),
                      one);
  for (int i = 0; i < 3; ++i) e = hn::Mul(e, e);
  return e;
}

/// Bytes of neighbouring columns as numbers.
HWY_INLINE V load_grey(const std::uint8_t* bytes) {
  const hn::Rebind<std::uint8_t, D> d8;
  const hn::Rebind<std::int32_t, D> d32;
  return hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d8, bytes)));
}

/// The stripes of one vector of columns.
struct Stripe {
  V centre;  ///< row
  V sigma;
  V amplitude;
  V background;  ///< at the centre
  V tilt;        ///< background's change per row
};

/// Successive rows of neighbouring columns.
struct Walk {
  const std::uint8_t* pixels;  ///< first row, first column
  std::size_t stride_bytes;
  int first_row;
  int row_count;

  /// The first row as seen from `row`.
  HWY_INLINE V first_from(V row) const { return hn::Sub(hn::Set(d, static_cast<float>(first_row)), row); }

  HWY_INLINE V row(int i) const { return load_grey(pixels + static_cast<std::size_t>(i) * stride_bytes); }
};

/// Start values from the moments of what stands above a cut at k_cut_ratio of the brightest pixel, around the
/// candidate's block.  Of a Gaussian cut at the share f of its height A, with q = area / (cut sd): A = cut /
/// f with 1 / f = 0.982 + 0.353 q, and sigma = sd (1.239 + 2.346 / q - 0.625 / q^2), to 0.3 % and 0.6 % for f
/// from 0.35 to 0.75 (least squares over the closed forms).  So the brightest pixel, mostly speckle, decides
/// nothing.
HWY_INLINE Stripe start_values(const Walk& walk, V middle, V half_window, V top, V background) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const V cut = hn::Max(hn::Mul(hn::Sub(top, background), hn::Set(d, k_cut_ratio)), one);
  const V level = hn::Add(background, cut);
  V area = zero, moment = zero, square = zero;
  V row = walk.first_from(middle);
  for (int i = 0; i < walk.row_count; ++i) {
    const V above = hn::Max(hn::Sub(walk.row(i), level), zero);
    const V weight = hn::IfThenElseZero(hn::Le(hn::Abs(row), half_window), above);
    const V weighted_row = hn::Mul(weight, row);
    area = hn::Add(area, weight);
    moment = hn::Add(moment, weighted_row);
    square = hn::MulAdd(weighted_row, row, square);
    row = hn::Add(row, one);
  }
  const V per_area = hn::Div(one, hn::Max(area, hn::Set(d, 0.5F)));
  const V centre = hn::Mul(moment, per_area);
  const V variance = hn::NegMulAdd(centre, centre, hn::Mul(square, per_area));
  // A single pixel has no variance; the least is that of a stripe as narrow as a pixel.
  const V sd = hn::Sqrt(hn::Max(variance, hn::Set(d, 0.1F)));
  const V per_q = hn::Min(hn::Mul(hn::Mul(cut, sd), per_area), one);
  const V factor =
      hn::MulAdd(hn::MulAdd(per_q, hn::Set(d, -0.625F), hn::Set(d, 2.346F)), per_q, hn::Set(d, 1.239F));
  return {.centre = hn::Add(centre, middle),
          .sigma = hn::Mul(sd, factor),
          .amplitude = hn::MulAdd(hn::Div(area, sd), hn::Set(d, 0.353F), hn::Mul(cut, hn::Set(d, 0.982F))),
          .background = background,
          .tilt = zero};
}

/// Sum and number of the grey values at more than `inner` and up to `outer` rows from the centre, on one
/// side: `side` is -1 before it, +1 after it.
struct SideLevel {
  V sum, count;
};
HWY_INLINE SideLevel side_level(const Walk& walk, V centre, float side, V inner, V outer) {
  SideLevel level{hn::Zero(d), hn::Zero(d)};
  const V step = hn::Set(d, side), one = hn::Set(d, 1.0F);
  V distance = hn::Mul(walk.first_from(centre), step);
  for (int i = 0; i < walk.row_count; ++i) {
    const M edge = hn::And(hn::Gt(distance, inner), hn::Le(distance, outer));
    level.sum = hn::Add(level.sum, hn::IfThenElseZero(edge, walk.row(i)));
    level.count = hn::Add(level.count, hn::IfThenElseZero(edge, one));
    distance = hn::Add(distance, step);
  }
  return level;
}

/// Background from both sides' means; a side that is cut off or holds another stripe takes the other's.
HWY_INLINE void set_background(const SideLevel& side_before, const SideLevel& side_after, V inner, V outer,
                               Stripe& stripe) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F), least = hn::Set(d, 1.5F);
  V before = hn::Div(side_before.sum, hn::Max(side_before.count, one)),
    after = hn::Div(side_after.sum, hn::Max(side_after.count, one));
  const M no_before = hn::Lt(side_before.count, least), no_after = hn::Lt(side_after.count, least);
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

/// What one round of the fit learns; each of the shape before the step.
struct Round {
  FitEvidenceOf<V> evidence;
  V skew;     ///< Peak::skew
  M settled;  ///< a further round would change little
};

/// One Gauss-Newton step of the least squares of a Gaussian; background and tilt as they are.  Without
/// `Judge` every row has the same weight and only the stripe is changed: enough to come near.
template <bool Judge>
HWY_INLINE Round improve(const Walk& walk, const FitWeights& weights, Stripe& stripe) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const V read_variance = hn::Set(d, weights.read_variance_grey2);
  const V gain = hn::Set(d, weights.gain_grey);
  const V speckle = hn::Set(d, weights.contrast * weights.contrast);
  const V per_sigma = hn::Div(one, stripe.sigma);
  const V full_scale = hn::Set(d, k_below_full), reach_squared = hn::Set(d, k_reach_sigma * k_reach_sigma);
  const V base_variance = hn::MulAdd(gain, hn::Max(stripe.background, zero), read_variance);

  // Sums over the rows with g = exp(-u^2 / 2), weight w and residual r: of w g^2 u^k, of w g r u^k, and of
  // w^2 g^4 u^k.
  V gg0 = zero, gg2 = zero, gg4 = zero, gr0 = zero, gr1 = zero, gr2 = zero;
  V speckled0 = zero, speckled2 = zero, energy = zero, residual_energy = zero, gg6 = zero, gr3 = zero;
  V x = walk.first_from(stripe.centre);
  for (int i = 0; i < walk.row_count; ++i) {
    const V grey = walk.row(i);
    const V u = hn::Mul(x, per_sigma), u2 = hn::Mul(u, u);
    const M inside = hn::Lt(u2, reach_squared), full = hn::Gt(grey, full_scale),
            used = hn::AndNot(full, inside);
    const V g =
        hn::IfThenElseZero(used, gaussian(hn::Min(hn::Mul(u2, hn::Set(d, 1.0F / 16)), hn::Set(d, 1.5F))));
    const V mean = hn::Mul(stripe.amplitude, g);
    const V variance = hn::MulAdd(mean, hn::MulAdd(mean, speckle, gain), base_variance);
    const V weighted = hn::Mul(hn::ApproximateReciprocal(variance), g);
    const V residual = hn::Sub(grey, hn::MulAdd(x, stripe.tilt, hn::Add(stripe.background, mean)));
    const V gg = hn::Mul(weighted, g), ggu2 = hn::Mul(gg, u2), gr = hn::Mul(weighted, residual),
            gru = hn::Mul(gr, u);
    gg0 = hn::Add(gg0, gg);
    gg2 = hn::Add(gg2, ggu2);
    const V ggu4 = hn::Mul(ggu2, u2);
    gg4 = hn::Add(gg4, ggu4);
    gr0 = hn::Add(gr0, gr);
    gr1 = hn::Add(gr1, gru);
    gr2 = hn::MulAdd(gru, u, gr2);
    if constexpr (Judge) {
      speckled0 = hn::MulAdd(gg, gg, speckled0);
      speckled2 = hn::MulAdd(gg, ggu2, speckled2);
      energy = hn::MulAdd(mean, mean, energy);
      const V counted_residual = hn::IfThenElseZero(used, residual);
      residual_energy = hn::MulAdd(counted_residual, counted_residual, residual_energy);
      gg6 = hn::MulAdd(ggu4, u2, gg6);
      gr3 = hn::MulAdd(gru, u2, gr3);
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
  // What a further round would change; nothing at all is taken for very little, so that no product
  // underflows.
  const V least = hn::Set(d, 1e-6F);
  const V change = hn::Max(hn::MulAdd(hn::Add(hn::Abs(step), hn::Abs(step_sigma)), per_sigma,
                                      hn::Div(hn::Abs(step_amplitude), hn::Max(stripe.amplitude, one))),
                           least);
  const V left = hn::Mul(hn::Max(hn::Min(hn::Abs(step), stripe.sigma), least), hn::Min(change, one));
  // Least squares of (u^3 - cubic u) g, which neither place nor height nor width can take up.
  const V cubic = hn::Div(gg4, gg2);
  const V skew =
      hn::Div(hn::NegMulAdd(cubic, gr1, gr3),
              hn::Mul(hn::Max(hn::NegMulAdd(cubic, gg4, gg6), tiny), hn::Max(stripe.amplitude, one)));
  const auto within = [](V value, V low, V high) { return hn::Max(low, hn::Min(value, high)); };
  stripe.centre = hn::Add(stripe.centre, within(step, hn::Neg(stripe.sigma), stripe.sigma));
  stripe.amplitude =
      within(hn::Add(stripe.amplitude, step_amplitude), hn::Mul(stripe.amplitude, hn::Set(d, 0.5F)),
             hn::Mul(stripe.amplitude, hn::Set(d, 2.0F)));
  stripe.sigma = within(hn::Add(stripe.sigma, step_sigma), hn::Mul(stripe.sigma, hn::Set(d, 0.7F)),
                        hn::Mul(stripe.sigma, hn::Set(d, 1.5F)));
  stripe.sigma = hn::Max(hn::Set(d, k_min_sigma_px), hn::Min(stripe.sigma, hn::Set(d, k_max_sigma_px)));
  // The error of the centre is sum(w m' e) / information, and that of the stripe's light sum(w g e) / (gg0 A)
  // with m' = A g u / sigma.  Of speckle e = A g s the first has the variance sum(w^2 m'^2 (A g)^2) S /
  // information^2, S the speckle's power, the second sum(w^2 g^4) S / gg0^2.  What the weights hold for
  // speckle is not camera noise.
  const V per_information = hn::Div(one, information), per_light = hn::Div(one, hn::Max(gg0, tiny));
  const V amplitude_squared = hn::Max(hn::Mul(stripe.amplitude, stripe.amplitude), tiny);
  const V centre_gain =
      hn::Mul(hn::Div(amplitude_squared, hn::Mul(stripe.sigma, stripe.sigma)),
              hn::Mul(hn::Mul(amplitude_squared, per_information), hn::Mul(speckled2, per_information)));
  const V light_gain = hn::Mul(speckled0, hn::Mul(per_light, per_light));
  const V least_noise = hn::Set(d, k_least_noise_ratio);
  const auto camera_noise = [&](V variance, V gain_of_speckle) {
    return hn::Max(hn::NegMulAdd(speckle, gain_of_speckle, variance), hn::Mul(least_noise, variance));
  };
  return {.evidence = {.misfit = hn::Sqrt(hn::Div(residual_energy, hn::Max(energy, one))),
                       .centre_variance = camera_noise(per_information, centre_gain),
                       .centre_gain = centre_gain,
                       .light_variance = camera_noise(hn::Div(per_light, amplitude_squared), light_gain),
                       .light_gain = light_gain,
                       .light_per_width = hn::Mul(gg2, per_light)},
          .skew = skew,
          .settled = hn::And(hn::Lt(hn::Mul(hn::Mul(left, left), information), hn::Set(d, k_settled_ratio)),
                             hn::Lt(change, hn::Set(d, k_settled_change)))};
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::stripe
HWY_AFTER_NAMESPACE();
