// SPDX-License-Identifier: MIT
#include "host/calibration/rings/mosaic.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace biteline::calibration {
namespace {

/// Mean grey of the pixels with even or odd column (bit 0) and row (bit 1).
using Phases = std::array<double, 4>;

/// Small enough to follow light and print, and with so many pixels (256 of each kind) that noise of 5 grey
/// levels leaves 0.3 of a mean.
constexpr int k_tile_px = 32;
/// What two amplifiers of a grey sensor differ by stays below 2 %; colours differ by 10 % and more.
constexpr double k_least_contrast = 0.06;
/// The two greens of a mosaic are equal, as far as light and print allow.
constexpr double k_most_green_share = 0.35;
/// Of the tiles, that show the same pattern; print and edges spoil some.
constexpr double k_least_tiles_share = 0.7;
constexpr double k_dark_grey = 16, k_cut_grey = 250;

Phases phases_of(const image::GreyImage& picture, int left, int top) {
  Phases sums{};
  for (int v = top; v < top + k_tile_px; ++v) {
    const auto row = picture.row(v);
    for (int u = left; u < left + k_tile_px; ++u)
      sums[static_cast<std::size_t>((u & 1) + 2 * (v & 1))] += row[static_cast<std::size_t>(u)];
  }
  for (double& sum : sums) sum /= k_tile_px * k_tile_px / 4.0;
  return sums;
}

double mean(const Phases& phases) {
  return (phases[0] + phases[1] + phases[2] + phases[3]) / 4;
}

}  // namespace

bool is_mosaic(const image::GreyImage& picture) {
  std::vector<Phases> tiles;  // each as a share of its own mean, so that light and print do not count
  Phases all{};
  for (int top = 0; top + k_tile_px <= picture.height_px; top += k_tile_px) {
    for (int left = 0; left + k_tile_px <= picture.width_px; left += k_tile_px) {
      Phases phases = phases_of(picture, left, top);
      const double grey = mean(phases);
      if (grey < k_dark_grey || *std::ranges::max_element(phases) > k_cut_grey) continue;
      for (double& phase : phases) phase /= grey;
      for (std::size_t i = 0; i < phases.size(); ++i) all[i] += phases[i];
      tiles.push_back(phases);
    }
  }
  if (tiles.size() < 4) return false;
  for (double& phase : all) phase /= static_cast<double>(tiles.size());
  const auto [least, most] = std::ranges::minmax_element(all);
  const double contrast = *most - *least;
  if (contrast < k_least_contrast) return false;
  // Greens stand on one of the diagonals.  Rows or columns in turns differ along both.
  const double off_first = std::abs(all[0] - all[3]), off_second = std::abs(all[1] - all[2]);
  if (std::min(off_first, off_second) > k_most_green_share * contrast) return false;
  const auto low = static_cast<std::size_t>(least - all.begin()),
             high = static_cast<std::size_t>(most - all.begin());
  const auto alike =
      std::ranges::count_if(tiles, [&](const Phases& tile) { return tile[high] - tile[low] > contrast / 3; });
  return static_cast<double>(alike) >= k_least_tiles_share * static_cast<double>(tiles.size());
}

}  // namespace biteline::calibration
