// SPDX-License-Identifier: MIT
// One candidate, looked at closely: where exactly, how wide, how sure.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/stripe/peak_extractor_state.hpp"

namespace biteline::stripe {
namespace {

constexpr int k_full_scale = 255;
/// Half of the longest stretch looked at: a stripe of 24 px at half height, seen down to a hundredth, is 62 px long.
constexpr int k_max_half = 40;
/// FWHM of a Gaussian over its standard deviation: 2 sqrt(2 ln 2).
constexpr float k_fwhm_per_sigma = 2.3548F;

/// The stretch of one column around a candidate.
struct Stretch {
  std::array<float, 2 * k_max_half + 1> grey;
  int first_row{0};
  int count{0};
  int top{0};         ///< index of the maximum
  bool clipped{false};///< the stripe runs over the region's edge
  int saturated{0};   ///< pixels at full scale
  float background{0};
  float height{0};    ///< maximum above background

  [[nodiscard]] float above(int i) const { return grey[static_cast<std::size_t>(i)] - background; }
};

struct Moments {
  float centre{0};  ///< index
  float sigma{0};
};

const std::uint8_t* pixel_column(const FrameRows& frame, int column) { return frame.pixels + column; }

/// Reads the stripe's surroundings: from the maximum both ways until a twentieth of the height, and half as far again.
bool read_stretch(const FrameRows& frame, int column, const Candidate& candidate, float threshold_grey, Stretch& out) {
  const std::uint8_t* pixels = pixel_column(frame, column);
  const auto grey = [&](int row) { return static_cast<int>(pixels[static_cast<std::size_t>(row) * frame.stride_bytes]); };
  const int block_first = candidate.block * k_block_rows;
  const int block_last = std::min(frame.height_px, block_first + k_block_rows) - 1;
  int top = block_first, plateau_last = block_first;
  for (int row = block_first; row <= block_last; ++row) {
    if (grey(row) > grey(top)) top = plateau_last = row;
    if (grey(row) == grey(top) && row == plateau_last + 1) plateau_last = row;
  }
  // The middle of a saturated plateau, which may reach into the next block.
  if (grey(top) == k_full_scale) {
    while (plateau_last + 1 < frame.height_px && plateau_last - top < k_max_half && grey(plateau_last + 1) == k_full_scale) ++plateau_last;
    top = (top + plateau_last) / 2;
  }

  const int lowest = std::max(0, top - k_max_half), highest = std::min(frame.height_px - 1, top + k_max_half);
  // Background: the lower of the two sides' quietest runs of three.
  const auto walk = [&](int step, int limit) {
    int row = top;
    int least = grey(top), least_row = top;
    while (row != limit) {
      row += step;
      const int value = grey(row);
      if (value < least) least = value, least_row = row;
      // Risen again to half the height: the next stripe.
      if (2 * (value - least) > grey(top) - least && value > least + static_cast<int>(threshold_grey)) return least_row;
      if (20 * value <= grey(top) && std::abs(row - top) >= 3) break;
    }
    return row;
  };
  int first = walk(-1, lowest), last = walk(+1, highest);
  const int margin = 2 + (last - first) / 8;
  const bool open_first = first == lowest, open_last = last == highest;
  first = std::max(lowest, first - (open_first ? 0 : margin));
  last = std::min(highest, last + (open_last ? 0 : margin));

  out.first_row = first;
  out.count = last - first + 1;
  out.top = top - first;
  out.saturated = 0;
  for (int row = first; row <= last; ++row) {
    const int value = grey(row);
    out.grey[static_cast<std::size_t>(row - first)] = static_cast<float>(value);
    if (value == k_full_scale) ++out.saturated;
  }
  const float low_side = std::min(out.grey[0], out.grey[static_cast<std::size_t>(out.count - 1)]);
  out.background = low_side;
  out.height = out.grey[static_cast<std::size_t>(out.top)] - out.background;
  out.clipped = (first == 0 && out.above(0) > 0.1F * out.height) ||
                (last == frame.height_px - 1 && out.above(out.count - 1) > 0.1F * out.height);
  return out.height >= threshold_grey;
}

/// First and second moment of what is above a tenth of the height, contiguous with the maximum.
Moments moments(const Stretch& s) {
  const float floor = 0.1F * s.height;
  int first = s.top, last = s.top;
  while (first > 0 && s.above(first - 1) > floor) --first;
  while (last + 1 < s.count && s.above(last + 1) > floor) ++last;
  float sum = 0, sum_i = 0, sum_ii = 0;
  for (int i = first; i <= last; ++i) {
    const float weight = s.above(i), x = static_cast<float>(i - s.top);
    sum += weight;
    sum_i += weight * x;
    sum_ii += weight * x * x;
  }
  const float mean = sum_i / sum;
  return {.centre = static_cast<float>(s.top) + mean, .sigma = std::sqrt(std::max(0.05F, sum_ii / sum - mean * mean))};
}

/// Where the stripe crosses half its height, on each side, by linear interpolation.
struct Edges {
  float first{0}, last{0};
};

Edges half_height_edges(const Stretch& s) {
  const float half = 0.5F * s.height;
  int first = s.top, last = s.top;
  while (first > 0 && s.above(first - 1) > half) --first;
  while (last + 1 < s.count && s.above(last + 1) > half) ++last;
  Edges edges{.first = static_cast<float>(first), .last = static_cast<float>(last)};
  if (first > 0) edges.first -= (s.above(first) - half) / (s.above(first) - s.above(first - 1));
  if (last + 1 < s.count) edges.last += (s.above(last) - half) / (s.above(last) - s.above(last + 1));
  return edges;
}

float parabola_top(const Stretch& s) {
  if (s.top == 0 || s.top + 1 >= s.count) return static_cast<float>(s.top);
  const float before = s.above(s.top - 1), at = s.above(s.top), after = s.above(s.top + 1);
  const float bend = before - 2 * at + after;
  return static_cast<float>(s.top) + (bend < 0 ? 0.5F * (before - after) / bend : 0.0F);
}

/// Zero of the first derivative of the stretch smoothed by a Gaussian of the stripe's width, near `start`.
float derivative_zero(const Stretch& s, Moments start) {
  const auto slope = [&](float centre) {
    float sum = 0;
    for (int i = 0; i < s.count; ++i) {
      const float u = (static_cast<float>(i) - centre) / start.sigma;
      if (std::fabs(u) < 4) sum += u * std::exp(-0.5F * u * u) * s.above(i);
    }
    return sum;
  };
  float low = start.centre - 1.5F, high = start.centre + 1.5F;
  for (int i = 0; i < 16; ++i) {
    const float middle = 0.5F * (low + high);
    (slope(middle) > 0 ? low : high) = middle;
  }
  return 0.5F * (low + high);
}

struct Fit {
  float centre{0};
  float sigma{0};
  float amplitude{0};
  float sigma_centre{0};
  bool poor{false};
};

/// Weighted least squares of a Gaussian on a constant: centre, amplitude and width by Gauss-Newton with the noise
/// model's weights at the current estimate (iteratively reweighted, hence maximum likelihood to first order; Kay 1993,
/// Statistical Signal Processing, ch. 7 and 8).  Saturated pixels carry no weight.
Fit matched_fit(const Stretch& s, Moments start, const NoiseModel& noise) {
  constexpr int k_rounds = 3;
  const float read_variance = noise.read_noise_grey * noise.read_noise_grey;
  const float speckle_variance = noise.speckle_contrast * noise.speckle_contrast;
  Fit fit{.centre = start.centre, .sigma = start.sigma, .amplitude = s.height, .sigma_centre = 0, .poor = false};
  for (int round = 0; round < k_rounds; ++round) {
    // Normal equations for (centre, amplitude, sigma); 3 x 3, symmetric.
    float cc = 0, ca = 0, cs = 0, aa = 0, as = 0, ss = 0, rc = 0, ra = 0, rs = 0;
    for (int i = 0; i < s.count; ++i) {
      if (s.grey[static_cast<std::size_t>(i)] >= k_full_scale) continue;
      const float u = (static_cast<float>(i) - fit.centre) / fit.sigma;
      if (std::fabs(u) > 3.5F) continue;
      const float g = std::exp(-0.5F * u * u), mean = fit.amplitude * g;
      const float weight = 1 / (read_variance + noise.gain_grey_per_electron * (mean + s.background) + speckle_variance * mean * mean);
      const float residual = s.above(i) - mean;
      const float by_centre = mean * u / fit.sigma, by_sigma = mean * u * u / fit.sigma;
      cc += weight * by_centre * by_centre;
      ca += weight * by_centre * g;
      cs += weight * by_centre * by_sigma;
      aa += weight * g * g;
      as += weight * g * by_sigma;
      ss += weight * by_sigma * by_sigma;
      rc += weight * by_centre * residual;
      ra += weight * g * residual;
      rs += weight * by_sigma * residual;
    }
    // Cramer's rule on the 3 x 3 system.
    const float m00 = aa * ss - as * as, m01 = as * cs - ca * ss, m02 = ca * as - aa * cs;
    const float det = cc * m00 + ca * m01 + cs * m02;
    if (!(det > 0)) {
      fit.poor = true;
      return fit;
    }
    const float m11 = cc * ss - cs * cs, m12 = ca * cs - cc * as, m22 = cc * aa - ca * ca;
    const float step_c = (m00 * rc + m01 * ra + m02 * rs) / det;
    const float step_a = (m01 * rc + m11 * ra + m12 * rs) / det;
    const float step_s = (m02 * rc + m12 * ra + m22 * rs) / det;
    fit.centre += std::clamp(step_c, -fit.sigma, fit.sigma);
    fit.amplitude = std::max(0.5F * fit.amplitude, fit.amplitude + step_a);
    fit.sigma = std::clamp(fit.sigma + step_s, 0.7F * fit.sigma, 1.4F * fit.sigma);
    fit.sigma_centre = std::sqrt(m00 / det);
  }
  fit.poor = std::fabs(fit.centre - start.centre) > start.sigma;
  return fit;
}

}  // namespace

bool rt_fit_peak(const FrameRows& frame, int column, const Candidate& candidate, const PeakConfig& config,
                 Peak& out) noexcept BITELINE_RT {
  Stretch stretch;
  if (!read_stretch(frame, column, candidate, config.threshold_grey, stretch)) return false;
  const Moments start = moments(stretch);
  const Fit fit = matched_fit(stretch, start, config.noise);

  float centre = fit.centre;
  float width_px = fit.sigma * k_fwhm_per_sigma;
  switch (config.mode) {
    case PeakMode::Matched: break;
    case PeakMode::Maximum: centre = parabola_top(stretch); break;
    case PeakMode::CentreOfGravity: centre = start.centre; break;
    case PeakMode::FirZeroCrossing: centre = derivative_zero(stretch, start); break;
    case PeakMode::Threshold: {
      const Edges edges = half_height_edges(stretch);
      centre = 0.5F * (edges.first + edges.last);
      width_px = edges.last - edges.first;
      break;
    }
  }
  out.row_px = static_cast<float>(stretch.first_row) + centre;
  out.sigma_row_px = fit.sigma_centre;
  out.amplitude = fit.amplitude;
  out.width_px = width_px;
  out.background = stretch.background;
  out.flags = 0;
  if (stretch.saturated > 0) out.flags |= k_peak_saturated;
  if (stretch.clipped) out.flags |= k_peak_clipped;
  if (width_px > config.width_max_px) out.flags |= k_peak_wide;
  if (width_px < config.width_min_px) out.flags |= k_peak_narrow;
  if (fit.poor) out.flags |= k_peak_poor_fit;
  return true;
}

}  // namespace biteline::stripe
