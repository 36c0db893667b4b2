// SPDX-License-Identifier: MIT
#pragma once
/// \file Normals of the side's height field.

#include <optional>

#include "common/geometry/se3.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// A cell of the side's grid.
struct SideCell {
  int row;
  int col;
};
[[nodiscard]] SideCell cell_of(const SideGrid& grid, const OutlinePlace& place);

/// Outward unit normal in shoe, from the slopes to the cells around; none where these were not seen.
[[nodiscard]] std::optional<Vec3> field_normal(const Side& side, const SideCell& cell);

/// The upper's normal beside a place in shoe: mean over 2 to 6 mm above; level where nothing was seen there.
[[nodiscard]] Vec3 normal_above(const Side& side, const Vec3& p);

}  // namespace biteline::bite_line
