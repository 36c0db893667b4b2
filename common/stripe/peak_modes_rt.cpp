// SPDX-License-Identifier: MIT
// The field's other peak modes, for comparison and for customers' habits.  They start from the fitted peak,
// so that all modes see the same background and the same stretch of stripe.
#include <algorithm>
#include <cmath>

#include "common/stripe/peak_extractor_state.hpp"

namespace biteline::stripe {
namespace {

constexpr float k_fwhm_per_sigma = 2.3548F;  // 2 sqrt(2 ln 2)

/// One column's grey above the peak's background.
struct ColumnAbove {
  const FrameRows& frame;
  int column;
  float background;

  [[nodiscard]] float operator()(int row) const {
    return static_cast<float>(frame.pixels[static_cast<std::size_t>(row) * frame.stride_bytes +
                                           static_cast<std::size_t>(column)]) -
           background;
  }
};

struct Run {
  int first, last;
};

/// Rows contiguous with `top` that are above `level`; at most two widths long on either side.
Run run_above(const ColumnAbove& above, int top, float level, int reach) {
  const int lowest = std::max(0, top - reach), highest = std::min(above.frame.height_px - 1, top + reach);
  Run run{.first = top, .last = top};
  while (run.first > lowest && above(run.first - 1) > level) --run.first;
  while (run.last < highest && above(run.last + 1) > level) ++run.last;
  return run;
}

int brightest(const ColumnAbove& above, float centre, float width_px) {
  const int first = std::max(0, static_cast<int>(centre - width_px)),
            last = std::min(above.frame.height_px - 1, static_cast<int>(centre + width_px) + 1);
  int top = first;
  for (int row = first; row <= last; ++row) {
    if (above(row) > above(top)) top = row;
  }
  return top;
}

float parabola_top(const ColumnAbove& above, int top) {
  if (top == 0 || top + 1 >= above.frame.height_px) return static_cast<float>(top);
  const float before = above(top - 1), at = above(top), after = above(top + 1);
  const float bend = before - 2 * at + after;
  // A neighbour beyond the stretch that was looked at may be brighter: the top is then no top, and stays.
  return static_cast<float>(top) +
         (bend < 0 ? std::clamp(0.5F * (before - after) / bend, -0.5F, 0.5F) : 0.0F);
}

float centre_of_gravity(const ColumnAbove& above, int top, int reach) {
  const Run run = run_above(above, top, 0.1F * above(top), reach);
  float sum = 0, moment = 0;
  for (int row = run.first; row <= run.last; ++row) {
    sum += above(row);
    moment += above(row) * static_cast<float>(row - top);
  }
  return static_cast<float>(top) + (sum > 0 ? moment / sum : 0.0F);
}

/// Rows from `row` towards `next` to where the level is crossed; at most one where it is not, as at the end
/// of the reach.
float rows_to_crossing(const ColumnAbove& above, int row, int next, float level) {
  return std::clamp((above(row) - level) / std::max(1.0F, above(row) - above(next)), 0.0F, 1.0F);
}

/// Where the run crosses half height, by linear interpolation on either side.
float mean_of_edges(const ColumnAbove& above, int top, int reach, float& width_px) {
  const float half = 0.5F * above(top);
  const Run run = run_above(above, top, half, reach);
  float first = static_cast<float>(run.first), last = static_cast<float>(run.last);
  if (run.first > 0) first -= rows_to_crossing(above, run.first, run.first - 1, half);
  if (run.last + 1 < above.frame.height_px) last += rows_to_crossing(above, run.last, run.last + 1, half);
  width_px = last - first;
  return 0.5F * (first + last);
}

/// Zero of the first derivative of the column smoothed by a Gaussian of the stripe's width; `slope` is the
/// filtered second derivative there, the mode's measure of quality.
float derivative_zero(const ColumnAbove& above, float centre, float sigma) {
  const auto derivative = [&](float at) {
    const int first = std::max(0, static_cast<int>(at - 4 * sigma)),
              last = std::min(above.frame.height_px - 1, static_cast<int>(at + 4 * sigma) + 1);
    float sum = 0;
    for (int row = first; row <= last; ++row) {
      const float u = (static_cast<float>(row) - at) / sigma;
      if (std::fabs(u) < 4) sum += u * std::exp(-0.5F * u * u) * above(row);
    }
    return sum;
  };
  // Bisection: the smoothed stripe has one top within a standard deviation of the fitted centre.
  float low = centre - sigma, high = centre + sigma;
  for (int i = 0; i < 14; ++i) {
    const float middle = 0.5F * (low + high);
    (derivative(middle) > 0 ? low : high) = middle;
  }
  return 0.5F * (low + high);
}

}  // namespace

void rt_apply_mode(const FrameRows& frame, int column, PeakMode mode, Peak& peak) noexcept BITELINE_RT {
  // A stripe that the picture cuts off may be fitted beyond it (k_peak_clipped): no row there can be read.
  const bool seen = peak.row_px >= 0 && peak.row_px <= static_cast<float>(frame.height_px - 1);
  if (!seen) return;
  const ColumnAbove above{.frame = frame, .column = column, .background = peak.background};
  const int reach = 2 * static_cast<int>(peak.width_px) + 2;
  const int top = brightest(above, peak.row_px, peak.width_px);
  if (above(top) <= 0) return;  // only the fit sees a stripe here
  switch (mode) {
    case PeakMode::Matched:
      break;
    case PeakMode::Maximum:
      peak.row_px = parabola_top(above, top);
      break;
    case PeakMode::Threshold:
      peak.row_px = mean_of_edges(above, top, reach, peak.width_px);
      break;
    case PeakMode::CentreOfGravity:
      peak.row_px = centre_of_gravity(above, top, reach);
      break;
    case PeakMode::FirZeroCrossing:
      peak.row_px = derivative_zero(above, peak.row_px, peak.width_px / k_fwhm_per_sigma);
      break;
  }
}

}  // namespace biteline::stripe
