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

Layers find_layers_along(Side& side, const LayersConfig& config, std::span<const RunLook> looks) {
  constexpr SideField::Config k_field{};
  const auto steep = static_cast<float>(k_field.sigma_z_mm / k_field.sigma_s_mm);
  FirstLook look = first_look(side.field, config);
  const std::vector<float> climb = climb_of(side.field.grid, smooth_rows(side.field.grid, look.best.row));
  if (std::any_of(climb.begin(), climb.end(), [&](float c) { return std::abs(c) > steep; })) {
    side.field = SideField::build(side.shoe, side.outline, k_field, climb);
    look = first_look(side.field, config);
  }
  return find_layers(side.field, look, config, [&] { return Materials::of(side.shoe, side.field, looks); });
}

}  // namespace biteline::bite_line
