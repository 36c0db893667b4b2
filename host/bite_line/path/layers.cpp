// SPDX-License-Identifier: MIT
#include "host/bite_line/path/layers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace biteline::bite_line {

namespace {

constexpr double k_mean_mm = 8.5;  // along the line, of its place

/// A weak crease on a surface that lies nearly flat: a little in height is much along the surface.  On drawn
/// and scanned shoes a crease of 8 degrees where the surface goes in by 3 mm for each one up is off by up to
/// three.  With 0.7 all that is off by 2 mm on a canvas shoe's toe counts below 0.5.  Nothing where the
/// surface was not seen.
std::optional<float> sharpness(const SideField& field, const Crease& line, int col) {
  constexpr double k_plain_rad = 0.1;
  constexpr double k_least_rad = 0.02;
  constexpr int k_reach_rows = 4;
  const SideGrid& grid = field.grid;
  const int row = static_cast<int>(std::lround(line.row[static_cast<std::size_t>(col)]));
  if (row < k_reach_rows || row + k_reach_rows >= grid.rows) return std::nullopt;
  const std::size_t low = grid.at(row - k_reach_rows, col);
  const std::size_t high = grid.at(row + k_reach_rows, col);
  const auto turn_rad = static_cast<double>(line.turn_rad[static_cast<std::size_t>(col)]);
  if (field.seen[low] == 0 || field.seen[high] == 0 || std::isnan(turn_rad)) return std::nullopt;
  const double slope =
      static_cast<double>(field.o_mm[high] - field.o_mm[low]) / (2 * k_reach_rows * grid.row_mm);
  const double doubt = 0.7 * std::pow(slope * k_plain_rad / std::max(turn_rad, k_least_rad), 2);
  return static_cast<float>(1 / (1 + doubt));
}

}  // namespace

std::vector<float> sharp_along(const SideField& field, const Crease& line) {
  const SideGrid& grid = field.grid;
  // A point's place is a mean over its neighbours: all of them count.
  const int reach = static_cast<int>(std::lround(k_mean_mm / 2 / grid.col_mm));
  std::vector<float> sharp(static_cast<std::size_t>(grid.cols), 1.0F);
  // What was not seen is no sharper than what lies on its sides: a bridge leans on both.
  float last = 1;
  for (int col = 0; col < 2 * grid.cols; ++col) {
    const int at = col % grid.cols;
    const std::optional<float> seen = sharpness(field, line, at);
    last = seen.value_or(last);
    sharp[static_cast<std::size_t>(at)] = last;
  }
  last = 1;
  for (int col = 2 * grid.cols - 1; col >= 0; --col) {
    const int at = col % grid.cols;
    const std::optional<float> seen = sharpness(field, line, at);
    last = seen.value_or(last);
    float& here = sharp[static_cast<std::size_t>(at)];
    here = std::min(here, last);
  }
  std::vector<float> about;
  for (int col = 0; col < grid.cols; ++col) {
    float least = 1;
    for (int c = col - reach; c <= col + reach; ++c)
      least = std::min(least, sharp[static_cast<std::size_t>((c + grid.cols) % grid.cols)]);
    about.push_back(least);
  }
  return about;
}

}  // namespace biteline::bite_line
