// SPDX-License-Identifier: MIT
#include "host/calibration/rings/threshold.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace biteline::calibration {

namespace {

using Histogram = std::array<double, 256>;

/// Peaks closer than this are noise of one surface: 8-bit cameras have about 2 grey levels of it.
constexpr double k_least_contrast_grey = 16;
/// Share of the variance that two classes must explain; a single normal peak cut in two reaches 0.64.
constexpr double k_least_separability = 0.75;

Histogram smoothed(const Histogram& histogram) {
  Histogram result{};
  constexpr int k_reach = 3;  // grey levels, about the noise
  for (int i = 0; i < 256; ++i) {
    for (int j = std::max(0, i - k_reach); j <= std::min(255, i + k_reach); ++j) {
      result[static_cast<std::size_t>(i)] += histogram[static_cast<std::size_t>(j)];
    }
  }
  return result;
}

/// The valley between the two peaks.  Otsu 1979 finds the two classes and says how separate they are.
std::optional<float> valley(const Histogram& histogram) {
  double count = 0, sum = 0, square_sum = 0;
  for (int i = 0; i < 256; ++i) {
    const double n = histogram[static_cast<std::size_t>(i)];
    count += n;
    sum += n * i;
    square_sum += n * i * i;
  }
  if (count < 64) return std::nullopt;
  const double variance = square_sum / count - sum * sum / (count * count);
  if (variance < 1) return std::nullopt;
  double best = 0, low_mean = 0, high_mean = 0, low_count = 0, low_sum = 0;
  for (int i = 0; i < 255; ++i) {
    low_count += histogram[static_cast<std::size_t>(i)];
    low_sum += histogram[static_cast<std::size_t>(i)] * i;
    if (low_count < 1 || count - low_count < 1) continue;
    const double m_low = low_sum / low_count, m_high = (sum - low_sum) / (count - low_count);
    const double between =
        low_count * (count - low_count) / (count * count) * (m_high - m_low) * (m_high - m_low);
    if (between > best) {
      best = between;
      low_mean = m_low;
      high_mean = m_high;
    }
  }
  if (high_mean - low_mean < k_least_contrast_grey || best / variance < k_least_separability)
    return std::nullopt;
  const Histogram smooth = smoothed(histogram);
  // Only the middle half between the peaks: a valley hard at a peak would be noise of that peak.
  const int from = static_cast<int>(low_mean + 0.25 * (high_mean - low_mean));
  const int to = static_cast<int>(high_mean - 0.25 * (high_mean - low_mean));
  double least = smooth[static_cast<std::size_t>(from)];
  for (int i = from; i <= to; ++i) least = std::min(least, smooth[static_cast<std::size_t>(i)]);
  double level_sum = 0, levels = 0;  // the middle of a flat valley
  for (int i = from; i <= to; ++i) {
    if (smooth[static_cast<std::size_t>(i)] > least + 0.002 * count) continue;
    level_sum += i;
    levels += 1;
  }
  return static_cast<float>(level_sum / levels);
}

struct Grid {
  int columns{0}, rows{0}, step_px{0};
  std::vector<std::optional<float>> thresholds;

  [[nodiscard]] std::optional<float>& at(int column, int row) {
    return thresholds[static_cast<std::size_t>(row * columns + column)];
  }
};

Grid window_thresholds(const image::GreyImage& picture, int window_px) {
  Grid grid;
  grid.step_px = std::max(4, window_px / 2);
  grid.columns = std::max(1, (picture.width_px + grid.step_px - 1) / grid.step_px);
  grid.rows = std::max(1, (picture.height_px + grid.step_px - 1) / grid.step_px);
  grid.thresholds.resize(static_cast<std::size_t>(grid.columns * grid.rows));
  // One picture pixel in `stride` each way is enough for a histogram.
  const int stride = std::max(1, window_px / 64);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      Histogram histogram{};
      const int u0 = std::max(0, column * grid.step_px + grid.step_px / 2 - window_px / 2);
      const int v0 = std::max(0, row * grid.step_px + grid.step_px / 2 - window_px / 2);
      const int u1 = std::min(picture.width_px, u0 + window_px),
                v1 = std::min(picture.height_px, v0 + window_px);
      for (int v = v0; v < v1; v += stride) {
        for (int u = u0; u < u1; u += stride) histogram[picture.at(u, v)] += 1;
      }
      grid.at(column, row) = valley(histogram);
    }
  }
  return grid;
}

/// Gives windows without a threshold the mean of their neighbours', outwards from those that have one.
bool fill_gaps(Grid& grid) {
  if (std::none_of(grid.thresholds.begin(), grid.thresholds.end(),
                   [](const auto& t) { return t.has_value(); }))
    return false;
  for (bool gap = true; gap;) {
    gap = false;
    Grid next = grid;
    for (int row = 0; row < grid.rows; ++row) {
      for (int column = 0; column < grid.columns; ++column) {
        if (grid.at(column, row)) continue;
        float sum = 0;
        int count = 0;
        for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r) {
          for (int c = std::max(0, column - 1); c <= std::min(grid.columns - 1, column + 1); ++c) {
            if (!grid.at(c, r)) continue;
            sum += *grid.at(c, r);
            ++count;
          }
        }
        if (count > 0) next.at(column, row) = sum / static_cast<float>(count);
        gap = gap || count == 0;
      }
    }
    grid = std::move(next);
  }
  return true;
}

}  // namespace

std::vector<std::uint8_t> dark_mask(const image::GreyImage& picture, int window_px) {
  std::vector<std::uint8_t> mask(picture.pixels.size(), 0);
  Grid grid = window_thresholds(picture, window_px);
  if (!fill_gaps(grid)) return mask;
  std::vector<int> left(static_cast<std::size_t>(picture.width_px));
  std::vector<float> share(left.size());
  for (std::size_t u = 0; u < left.size(); ++u) {
    const float place = std::clamp(
        (static_cast<float>(u) - static_cast<float>(grid.step_px) / 2) / static_cast<float>(grid.step_px),
        0.0F, static_cast<float>(grid.columns - 1));
    left[u] = std::min(static_cast<int>(place), std::max(0, grid.columns - 2));
    share[u] = place - static_cast<float>(left[u]);
  }
  std::vector<float> line(static_cast<std::size_t>(grid.columns));
  for (int v = 0; v < picture.height_px; ++v) {
    const float place = std::clamp(
        (static_cast<float>(v) - static_cast<float>(grid.step_px) / 2) / static_cast<float>(grid.step_px),
        0.0F, static_cast<float>(grid.rows - 1));
    const int above = std::min(static_cast<int>(place), std::max(0, grid.rows - 2));
    const float below_share = place - static_cast<float>(above);
    for (int c = 0; c < grid.columns; ++c) {
      const float a = *grid.at(c, above), b = *grid.at(c, std::min(above + 1, grid.rows - 1));
      line[static_cast<std::size_t>(c)] = a + (b - a) * below_share;
    }
    const auto pixels = picture.row(v);
    std::uint8_t* out =
        mask.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(picture.width_px);
    for (std::size_t u = 0; u < left.size(); ++u) {
      const float a = line[static_cast<std::size_t>(left[u])];
      const float b = line[static_cast<std::size_t>(std::min(left[u] + 1, grid.columns - 1))];
      out[u] = static_cast<float>(pixels[u]) < a + (b - a) * share[u] ? 255 : 0;
    }
  }
  return mask;
}

}  // namespace biteline::calibration
