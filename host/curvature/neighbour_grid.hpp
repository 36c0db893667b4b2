// SPDX-License-Identifier: MIT
#pragma once
/// \file Neighbourhoods from a voxel grid: points sorted by cell, so that a search reads nine short runs of
/// memory.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace biteline::curvature {

/// Built once per cloud, then read by any number of threads.  Memory: 16 bytes per point and 4 per cell; the
/// cells grow until there are at most `max_cells`.
class NeighbourGrid {
 public:
  struct Config {
    float cell_mm{1.5F};  ///< radius searches up to this; larger ones look at more cells
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

  struct Hit {
    float distance2_mm2;
    std::uint32_t index;  ///< in grid order
  };
  /// All within the radius of the point `index` (in grid order), itself included, appended to `hits` in grid
  /// order.
  void within(std::uint32_t index, float radius_mm, std::vector<Hit>& hits) const;

  /// The `count` nearest (itself included), in no order; returns the distance of the farthest, mm.
  float nearest(std::uint32_t index, std::size_t count, std::vector<Hit>& hits) const;

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

}  // namespace biteline::curvature
