// SPDX-License-Identifier: MIT
#include "common/stripe/line_average.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/core/contracts.hpp"

namespace biteline::stripe {
namespace {

constexpr std::array k_half_widths{2, 3, 4, 6};

}  // namespace

LineAverage::LineAverage(const LineAverageConfig& config) : config_{config} {
  for (std::size_t w = 0; w < k_windows; ++w) {
    Window& window = windows_[w];
    window.each_side = k_half_widths[w];
    // Value at 0 of the parabola through offsets -n..n: weights (3 (3 n^2 + 3 n - 1) - 15 k^2) /
    // ((2n-1)(2n+1)(2n+3)).
    const double n = window.each_side;
    for (int k = 0; k <= window.each_side; ++k) {
      window.weight[static_cast<std::size_t>(k)] = static_cast<float>(
          (3 * (3 * n * n + 3 * n - 1) - 15.0 * k * k) / ((2 * n - 1) * (2 * n + 1) * (2 * n + 3)));
    }
    for (int i = -window.each_side; i <= window.each_side; ++i) {
      for (int j = -window.each_side; j <= window.each_side; ++j) {
        const auto apart = static_cast<std::size_t>(std::abs(i - j));
        if (apart > k_correlated_columns) continue;
        window.share[apart] += window.weight[static_cast<std::size_t>(std::abs(i))] *
                               window.weight[static_cast<std::size_t>(std::abs(j))];
      }
    }
  }
}

void LineAverage::rt_average(std::span<LinePoint> line, std::span<LinePoint> work,
                             float neighbour_correlation) const noexcept BITELINE_RT {
  BITELINE_EXPECTS(work.size() >= line.size() && neighbour_correlation >= 0 && neighbour_correlation < 1);
  // Falls with the square of the distance, as in light that optics blur (rt_estimate_speckle).
  const float once = neighbour_correlation, twice = once * once * once * once;
  std::array<float, k_windows> sigma_ratio;
  for (std::size_t w = 0; w < k_windows; ++w) {
    const auto& share = windows_[w].share;
    sigma_ratio[w] =
        std::sqrt(share[0] + share[1] * once + share[2] * twice + share[3] * twice * twice * once);
  }
  std::copy(line.begin(), line.end(), work.begin());
  const auto count = static_cast<std::ptrdiff_t>(line.size());
  std::ptrdiff_t first = 0, end = 0;  // the stretch [first, end) around the column
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    if (i >= end) {
      first = i;
      end = i + 1;
      while (end < count && work[static_cast<std::size_t>(end)].joined) ++end;
    }
    const LinePoint& own = work[static_cast<std::size_t>(i)];
    if (!own.present) continue;
    const auto room = std::min(i - first, end - 1 - i);
    float low = own.row_px - config_.consistency_sigma * own.sigma_row_px;
    float high = own.row_px + config_.consistency_sigma * own.sigma_row_px;
    for (std::size_t w = 0; w < k_windows; ++w) {
      const Window& window = windows_[w];
      if (window.each_side > room || window.each_side > config_.max_each_side) break;
      float row_px = window.weight[0] * own.row_px,
            variance = window.weight[0] * own.sigma_row_px * own.sigma_row_px;
      for (std::ptrdiff_t k = 1; k <= window.each_side; ++k) {
        const LinePoint& before = work[static_cast<std::size_t>(i - k)];
        const LinePoint& after = work[static_cast<std::size_t>(i + k)];
        row_px += window.weight[static_cast<std::size_t>(k)] * (before.row_px + after.row_px);
        variance += window.weight[static_cast<std::size_t>(k)] *
                    (before.sigma_row_px * before.sigma_row_px + after.sigma_row_px * after.sigma_row_px);
      }
      // Neighbours' own uncertainties, averaged with the same weights; never below the least that a window
      // could give.
      const float sigma_px =
          sigma_ratio[w] * std::sqrt(std::max(variance, 0.25F * own.sigma_row_px * own.sigma_row_px));
      low = std::max(low, row_px - config_.consistency_sigma * sigma_px);
      high = std::min(high, row_px + config_.consistency_sigma * sigma_px);
      if (low > high) break;
      line[static_cast<std::size_t>(i)].row_px = row_px;
      line[static_cast<std::size_t>(i)].sigma_row_px = sigma_px;
    }
  }
}

}  // namespace biteline::stripe
