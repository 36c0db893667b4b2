// SPDX-License-Identifier: MIT
#pragma once
/// \file A coarse grid of cells over a cloud: what is connected, what is flat, what lies alone.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/bite_line/pooled_vector.hpp"

namespace biteline::bite_line {

/// Dense grid; a cell keeps the number of its points and the sum of their offsets from its corner.
class Cells {
 public:
  struct Config {
    float cell_mm{4.0F};
    std::size_t max_cells{24'000'000};  ///< the cell grows until the grid fits
  };

  Cells(std::span<const Eigen::Vector3f> points, const Config& config);

  /// Cell of the i-th point, or -1 outside the grid (far outliers).
  [[nodiscard]] std::int32_t cell_of(std::size_t i) const { return cell_of_[i]; }
  /// Cells with points, ascending.
  [[nodiscard]] const std::vector<std::int32_t>& occupied() const { return occupied_; }
  /// Index into occupied() of an occupied cell.
  [[nodiscard]] std::size_t slot(std::int32_t cell) const {
    return static_cast<std::size_t>(slot_[static_cast<std::size_t>(cell)]);
  }
  /// Of the occupied cells, in their order: the number of points and their mean.
  [[nodiscard]] std::span<const std::uint32_t> counts() const { return counts_; }
  [[nodiscard]] std::span<const Eigen::Vector3f> means() const { return means_; }
  [[nodiscard]] float cell_mm() const { return cell_mm_; }
  /// What is given for the occupied cells, for each cell; 0 for empty ones.
  [[nodiscard]] PooledVector<std::uint8_t> by_cell(std::span<const std::uint8_t> by_slot) const;

  /// Labels the occupied cells that `keep` marks by 26-connected component, from 0; -1 for all others.
  /// Returns the number of components.
  int label(const std::vector<bool>& keep, std::vector<std::int32_t>& labels) const;
  /// Calls `visit` with the slot of each occupied cell among the 26 around an occupied cell, and of itself;
  /// `Before`: of the 13 before it alone.
  template <bool Before = false, class Visit>
  void around(std::size_t slot, Visit&& visit) const;

 private:
  [[nodiscard]] std::int32_t cell_at(const Eigen::Vector3f& point) const;

  float cell_mm_;
  float inverse_mm_{0};
  Eigen::Vector3f origin_{Eigen::Vector3f::Zero()};
  Eigen::Vector3i size_{Eigen::Vector3i::Zero()};
  PooledVector<std::int32_t> cell_of_;  ///< per point
  std::vector<std::int32_t> occupied_;
  PooledVector<std::int32_t> slot_;    ///< cell -> index into occupied_, -1 when empty
  std::vector<std::uint32_t> counts_;  ///< per occupied cell
  std::vector<Eigen::Vector3f> means_;
};

template <bool Before, class Visit>
void Cells::around(std::size_t slot, Visit&& visit) const {
  const std::int32_t cell = occupied_[slot];
  const int x = cell % size_.x();
  const int y = (cell / size_.x()) % size_.y();
  const int z = cell / (size_.x() * size_.y());
  const int last_z = Before ? z : std::min(size_.z() - 1, z + 1);
  for (int cz = std::max(0, z - 1); cz <= last_z; ++cz) {
    const int last_y = Before && cz == z ? y : std::min(size_.y() - 1, y + 1);
    for (int cy = std::max(0, y - 1); cy <= last_y; ++cy) {
      const int last_x = Before && cz == z && cy == y ? x - 1 : std::min(size_.x() - 1, x + 1);
      for (int cx = std::max(0, x - 1); cx <= last_x; ++cx) {
        const std::int32_t other = slot_[static_cast<std::size_t>((cz * size_.y() + cy) * size_.x() + cx)];
        if (other >= 0) visit(static_cast<std::size_t>(other));
      }
    }
  }
}

}  // namespace biteline::bite_line
