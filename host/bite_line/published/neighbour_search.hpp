// SPDX-License-Identifier: MIT
#pragma once
/// \file The neighbours of a grid's points, point after point.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/bite_line/published/neighbour_grid.hpp"

namespace biteline::published {

/// Points next to each other in grid order share their cell's surroundings: these are gathered once, and each
/// point looks through them a vector at a time.  One per thread; what it returns holds until it is asked
/// again.
class NeighbourSearch {
 public:
  explicit NeighbourSearch(const NeighbourGrid& grid) : grid_{&grid} {}

  /// All within the radius of the point `index`, itself included; all indices in grid order.
  [[nodiscard]] std::span<const std::uint32_t> within(std::uint32_t index, float radius_mm);

  struct Nearest {
    std::span<const std::uint32_t> index;
    float farthest_mm;
  };
  /// The `count` nearest, itself included, in no order; fewer where there are no more points.
  [[nodiscard]] Nearest nearest(std::uint32_t index, std::size_t count);

  /// Points to look through, side by side; beyond the last one, up to a whole vector, they lie far away.
  struct Block {
    Eigen::Vector3i cell{Eigen::Vector3i::Constant(-1)};
    int ring{-1};  ///< cells taken in on every side
    std::size_t size{0};
    std::vector<float> x, y, z;
    std::vector<std::uint32_t> index;
  };
  /// Those that were near enough, with room for one vector more.
  struct Near {
    std::vector<float> distance2_mm2;
    std::vector<std::uint32_t> index, chosen;
  };

 private:
  const Block& around(std::uint32_t index, int ring);

  const NeighbourGrid* grid_;
  std::array<Block, 2> blocks_;  ///< the next cells alone, and whatever wider ring was asked for last
  Near near_;
};

}  // namespace biteline::published
