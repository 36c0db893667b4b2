// SPDX-License-Identifier: MIT
#pragma once
/// \file The shoe's side as a height field: o(s, z), how far out the surface lies at each place of the
/// unrolled outline.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "host/bite_line/pooled_vector.hpp"
#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/shoe/shoe.hpp"
#include "host/bite_line/side/outer_layer.hpp"

namespace biteline::bite_line {

/// Row 0 is the lowest.  Columns go anticlockwise and close; they lie one after the other in memory.
struct SideGrid {
  int rows{0};
  int cols{0};
  double z_low_mm{0};
  double row_mm{0};
  double col_mm{0};

  [[nodiscard]] std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(col) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
  }
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  }
  [[nodiscard]] double z_mm(double row) const { return z_low_mm + (row + 0.5) * row_mm; }
};

struct SideField {
  struct Config {
    double row_mm{0.25};
    double col_mm{1.0};
    double top_mm{150.0};       ///< above the lowest point: a high heel's line and what lies above it
    double sigma_z_mm{0.5};     ///< close to the 0.4 mm of the line's definition, and a little calmer
    double sigma_s_mm{2.0};     ///< two profiles of a usual scan
    double lining_gap_mm{1.5};  ///< what lies this far behind the outermost surface is another layer
  };

  /// Height between the two slopes whose difference is the turn across a place.
  static constexpr double k_turn_reach_mm = 0.75;

  SideGrid grid;
  PooledVector<float> o_mm;           ///< smoothed
  PooledVector<float> turn_rad;       ///< turn of the surface within twice that height, concave > 0
  PooledVector<float> wide_turn_rad;  ///< the same within 3 mm
  PooledVector<std::uint8_t> seen;    ///< 1 where points support the place on all sides
  PooledVector<OutlinePlace> places;  ///< of every point; s also negative behind the outermost layer
  double points_per_mm2{0};           ///< of the outermost layer, where it was seen

  static SideField build(const Shoe& shoe, const Outline& outline, const Config& config);
};

}  // namespace biteline::bite_line
