// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/climb.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

std::vector<float> climb_of(const SideGrid& grid, std::span<const double> row) {
  constexpr double k_smooth_mm = 5.0;
  const std::vector<double> smooth = geometry::smooth_closed(row, k_smooth_mm / grid.col_mm);
  const std::size_t count = smooth.size();
  std::vector<float> climb;
  for (std::size_t col = 0; col < count; ++col) {
    const double rise_mm = (smooth[(col + 1) % count] - smooth[(col + count - 1) % count]) * grid.row_mm;
    climb.push_back(static_cast<float>(rise_mm / (2 * grid.col_mm)));
  }
  return climb;
}

namespace {

/// Whether the field ends where what lies above the course still tells something, or above a surface that
/// has hardly begun, and the shoe goes on.
bool ends_too_low(const Side& side, const ClosedPath& course, const EvidenceConfig& evidence) {
  const SideGrid& grid = side.field.grid;
  const double top_mm = grid.z_mm(grid.rows);
  if (static_cast<double>(side.shoe.box.max().z()) <= top_mm) return false;
  const int row = grid.rows - static_cast<int>(std::lround(evidence.above_to_mm / grid.row_mm));
  for (int col = 0; col < grid.cols; ++col) {
    const std::uint8_t* seen = side.field.seen.data() + grid.at(0, col);
    const std::uint8_t* first = std::find(seen, seen + grid.rows, 1);
    if (course.row[static_cast<std::size_t>(col)] > row || (first - seen > row && first - seen < grid.rows))
      return true;
  }
  return false;
}

}  // namespace

Layers find_layers_along(Side& side, const LayersConfig& config, std::span<const RunLook> looks) {
  constexpr double k_higher_mm = 60.0;
  SideField::Config of_field{};
  const auto steep = static_cast<float>(of_field.sigma_z_mm / of_field.sigma_s_mm);
  FirstLook look = first_look(side.field, config);
  if (ends_too_low(side, look.best, config.evidence)) {
    of_field.top_mm += k_higher_mm;
    side.field = SideField::build(side.shoe, side.outline, of_field);
    look = first_look(side.field, config);
  }
  const std::vector<float> climb = climb_of(side.field.grid, smooth_rows(side.field.grid, look.best.row));
  if (std::any_of(climb.begin(), climb.end(), [&](float c) { return std::abs(c) > steep; })) {
    side.field = SideField::build(side.shoe, side.outline, of_field, climb);
    look = first_look(side.field, config);
  }
  return find_layers(side.field, look, config, [&] { return Materials::of(side.shoe, side.field, looks); });
}

}  // namespace biteline::bite_line
