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
  BITELINE_EXPECTS(config.neighbour_correlation >= 0 && config.neighbour_correlation < 1);
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
    double variance = 0;
    for (int i = -window.each_side; i <= window.each_side; ++i) {
      for (int j = -window.each_side; j <= window.each_side; ++j) {
        variance += static_cast<double>(window.weight[static_cast<std::size_t>(std::abs(i))]) *
                    static_cast<double>(window.weight[static_cast<std::size_t>(std::abs(j))]) *
                    std::pow(static_cast<double>(config.neighbour_correlation), std::abs(i - j));
      }
    }
    window.sigma_ratio = static_cast<float>(std::sqrt(variance));
  }
}

void LineAverage::rt_average(std::span<LinePoint> line,
                             std::span<LinePoint> work) const noexcept BITELINE_RT {
  BITELINE_EXPECTS(work.size() >= line.size());
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
    for (const Window& window : windows_) {
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
          window.sigma_ratio * std::sqrt(std::max(variance, 0.25F * own.sigma_row_px * own.sigma_row_px));
      low = std::max(low, row_px - config_.consistency_sigma * sigma_px);
      high = std::min(high, row_px + config_.consistency_sigma * sigma_px);
      if (low > high) break;
      line[static_cast<std::size_t>(i)].row_px = row_px;
      line[static_cast<std::size_t>(i)].sigma_row_px = sigma_px;
    }
  }
}

}  // namespace biteline::stripe
