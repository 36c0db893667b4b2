// SPDX-License-Identifier: MIT
#include "host/bite_line/level/patch.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <tbb/parallel_for.h>

#include "host/bite_line/lanes.hpp"

namespace biteline::bite_line {

namespace {

int squared(int value) {
  return value * value;
}

/// Gaussian weights along a line of values `stride` apart.
void blur(std::vector<double>& values, std::size_t first, std::size_t count, std::size_t stride,
          std::span<const float> weights, std::vector<double>& room) {
  const auto reach = static_cast<std::ptrdiff_t>(weights.size() / 2);
  room.assign(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = values[first + i * stride];
    if (value == 0) continue;
    for (std::ptrdiff_t j = -reach; j <= reach; ++j) {
      const std::ptrdiff_t to = static_cast<std::ptrdiff_t>(i) + j;
      if (to < 0 || to >= static_cast<std::ptrdiff_t>(count)) continue;
      room[static_cast<std::size_t>(to)] +=
          value * static_cast<double>(weights[static_cast<std::size_t>(j + reach)]);
    }
  }
  for (std::size_t i = 0; i < count; ++i) values[first + i * stride] = room[i];
}

/// Sums over the points about a cell: of 1, x, z, o and their products, x and z in cells.
enum Sum : std::size_t { k_w, k_x, k_z, k_o, k_xx, k_xz, k_zz, k_xo, k_zo, k_sums };
using Sums = std::array<double, k_sums>;

/// Of the plane through these points, at a place: unlike their mean it is right on slopes and at borders.
double plane_at(const Sums& sums, double x, double z) {
  constexpr double k_least_spread = 0.3;  // squared: hardly a slope is known of what lies closer together
  const auto mean = [&](Sum sum) { return sums[sum] / sums[k_w]; };
  const double mean_x = mean(k_x), mean_z = mean(k_z), mean_o = mean(k_o);
  const double xx = mean(k_xx) - mean_x * mean_x + k_least_spread;
  const double zz = mean(k_zz) - mean_z * mean_z + k_least_spread;
  const double xz = mean(k_xz) - mean_x * mean_z;
  const double xo = mean(k_xo) - mean_x * mean_o;
  const double zo = mean(k_zo) - mean_z * mean_o;
  const double area = xx * zz - xz * xz;
  return mean_o + ((xo * zz - zo * xz) * (x - mean_x) + (zo * xx - xo * xz) * (z - mean_z)) / area;
}

}  // namespace

std::size_t step_between(const Cell& from, const Cell& to) {
  const auto* step = std::ranges::find_if(k_grid_steps, [&](GridStep by) {
    return by.cols == to.col - from.col && by.rows == to.row - from.row;
  });
  return static_cast<std::size_t>(step - k_grid_steps.begin());
}

void Patch::mark_about(const Cell& at, double reach_mm, std::vector<std::uint8_t>& cells) const {
  const int reach = static_cast<int>(std::lround(reach_mm / k_cell_mm));
  for (int c = std::max(0, at.col - reach); c <= std::min(cols - 1, at.col + reach); ++c) {
    for (int r = std::max(0, at.row - reach); r <= std::min(rows - 1, at.row + reach); ++r)
      if (squared(r - at.row) + squared(c - at.col) <= squared(reach)) cells[this->at(r, c)] = 1;
  }
}

Cell Patch::cell(const Vec2& place) const {
  return {.row = std::clamp(static_cast<int>((place.y() - window.z_mm) / k_cell_mm), 0, rows - 1),
          .col = std::clamp(static_cast<int>((place.x() - window.s_mm) / k_cell_mm), 0, cols - 1)};
}

Patch Patch::of(const Side& side, const Window& window, double sigma_mm) {
  constexpr double k_least_points = 3;  // within a circle of that radius, where points are few
  constexpr double k_least_weight = 1.5;
  Patch patch{.window = window,
              .rows = static_cast<int>(window.height_mm / k_cell_mm),
              .cols = static_cast<int>(window.length_mm / k_cell_mm),
              .o_mm = {},
              .seen = {}};
  const std::size_t cells = static_cast<std::size_t>(patch.rows) * static_cast<std::size_t>(patch.cols);
  std::array<std::vector<double>, k_sums> sums;
  for (std::vector<double>& sum : sums) sum.assign(cells, 0.0);
  const double turn_mm = side.outline.length_mm();
  for (const OutlinePlace& place : side.field.places) {
    if (place.s_mm < 0) continue;
    double s = std::fmod(static_cast<double>(place.s_mm) - window.s_mm, turn_mm);
    if (s < 0) s += turn_mm;
    const double x = s / k_cell_mm - 0.5;
    const double z = (static_cast<double>(place.z_mm) - window.z_mm) / k_cell_mm - 0.5;
    const auto col = static_cast<int>(std::floor(x + 0.5));
    const auto row = static_cast<int>(std::floor(z + 0.5));
    if (col >= patch.cols || row < 0 || row >= patch.rows) continue;
    const auto o = static_cast<double>(place.o_mm);
    const Sums of_point{1, x, z, o, x * x, x * z, z * z, x * o, z * o};
    for (std::size_t sum = 0; sum < k_sums; ++sum) sums[sum][patch.at(row, col)] += of_point[sum];
  }
  sigma_mm =
      std::max(sigma_mm, std::sqrt(k_least_points / (3.14159 * std::max(side.field.points_per_mm2, 0.1))));
  const std::vector<float> weights = gaussian(sigma_mm / k_cell_mm, 3);
  tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t sum) {
    std::vector<double> room;
    for (int col = 0; col < patch.cols; ++col)
      blur(sums[sum], patch.at(0, col), static_cast<std::size_t>(patch.rows), 1, weights, room);
    for (int row = 0; row < patch.rows; ++row)
      blur(sums[sum], patch.at(row, 0), static_cast<std::size_t>(patch.cols),
           static_cast<std::size_t>(patch.rows), weights, room);
  });
  patch.seen.assign(cells, 0);
  patch.o_mm.assign(cells, 0.0F);
  for (int col = 0; col < patch.cols; ++col) {
    for (int row = 0; row < patch.rows; ++row) {
      const std::size_t cell = patch.at(row, col);
      if (sums[k_w][cell] < k_least_weight) continue;
      Sums of_cell;
      for (std::size_t sum = 0; sum < k_sums; ++sum) of_cell[sum] = sums[sum][cell];
      patch.seen[cell] = 1;
      patch.o_mm[cell] = static_cast<float>(plane_at(of_cell, col, row));
    }
  }
  return patch;
}

}  // namespace biteline::bite_line
