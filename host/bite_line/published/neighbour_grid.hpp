// SPDX-License-Identifier: MIT
#pragma once
/// \file Points sorted by the cells of a voxel grid, so that a cell's surroundings are a few short runs of
/// memory.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace biteline::published {

/// Built once per cloud, then read by any number of threads.  Memory: 16 bytes per point and 4 per cell; the
/// cells grow until there are at most `max_cells`.
class NeighbourGrid {
 public:
  struct Config {
    float cell_mm{1.5F};  ///< best the radius of the searches; larger ones look at more cells
    std::size_t max_cells{48'000'000};
  };
  NeighbourGrid(std::span<const Eigen::Vector3f> points, const Config& config);

  [[nodiscard]] std::size_t size() const { return x_.size(); }
  [[nodiscard]] float cell_mm() const { return cell_mm_; }
  /// Points in the order of the grid: neighbours in space are neighbours in memory.
  [[nodiscard]] const float* x() const { return x_.data(); }
  [[nodiscard]] const float* y() const { return y_.data(); }
  [[nodiscard]] const float* z() const { return z_.data(); }
  /// Where each stood in the cloud.
  [[nodiscard]] const std::vector<std::uint32_t>& order() const { return order_; }

  /// The cell of a place within the cloud's box.
  [[nodiscard]] Eigen::Vector3i cell_at(const Eigen::Vector3f& place) const {
    return ((place - origin_) * inverse_mm_).cast<int>().cwiseMin(size_ - Eigen::Vector3i::Ones());
  }
  /// The points of a cell and of `ring` cells on every side of it: runs [begin, end) in grid order.
  template <class Run>
  void for_each_run(const Eigen::Vector3i& cell, int ring, Run&& run) const {
    const Eigen::Vector3i low = (cell.array() - ring).max(0);
    const Eigen::Vector3i high = (cell.array() + ring).min(size_.array() - 1);
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        const auto row = static_cast<std::size_t>(z * size_.y() + y) * static_cast<std::size_t>(size_.x());
        const std::uint32_t begin = start_[row + static_cast<std::size_t>(low.x())];
        const std::uint32_t end = start_[row + static_cast<std::size_t>(high.x()) + 1];
        if (begin < end) run(begin, end);
      }
    }
  }

 private:
  float cell_mm_;
  float inverse_mm_;
  Eigen::Vector3f origin_{Eigen::Vector3f::Zero()};
  Eigen::Vector3i size_{Eigen::Vector3i::Ones()};
  std::vector<float> x_, y_, z_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> start_;  ///< per cell, first point; one more at the end
};

/// Cell edge at which a cell of a surface holds about `count` points; from the cloud's own density.
[[nodiscard]] float cell_for_count(std::span<const Eigen::Vector3f> points, double count);

}  // namespace biteline::published
