// SPDX-License-Identifier: MIT
#include "host/bite_line/published/neighbour_grid.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace biteline::published {

namespace {

struct Bounds {
  Eigen::Vector3f low;
  Eigen::Vector3f high;
};

Bounds bounds_of(std::span<const Eigen::Vector3f> points) {
  Bounds bounds{points.front(), points.front()};
  for (const Eigen::Vector3f& p : points) {
    bounds.low = bounds.low.cwiseMin(p);
    bounds.high = bounds.high.cwiseMax(p);
  }
  return bounds;
}

}  // namespace

NeighbourGrid::NeighbourGrid(std::span<const Eigen::Vector3f> points, const Config& config)
    : cell_mm_{config.cell_mm}, inverse_mm_{1 / config.cell_mm} {
  if (points.empty()) {
    start_.assign(2, 0);
    return;
  }
  const Bounds bounds = bounds_of(points);
  const Eigen::Vector3f extent = bounds.high - bounds.low;
  const auto cells_at = [&](float cell_mm) {
    return ((extent.cast<double>() / static_cast<double>(cell_mm)).array().floor() + 1.0).prod();
  };
  while (cells_at(cell_mm_) > static_cast<double>(config.max_cells)) cell_mm_ *= 1.25F;
  inverse_mm_ = 1 / cell_mm_;
  origin_ = bounds.low;
  size_ = (extent * inverse_mm_).array().floor().cast<int>() + 1;
  const auto cells = static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) *
                     static_cast<std::size_t>(size_.z());

  std::vector<std::uint32_t> cell_of(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, points.size(), 16384}, [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Eigen::Vector3i cell = cell_at(points[i]);
      cell_of[i] = static_cast<std::uint32_t>((cell.z() * size_.y() + cell.y()) * size_.x() + cell.x());
    }
  });
  // Counting sort.
  start_.assign(cells + 1, 0);
  for (const std::uint32_t cell : cell_of) ++start_[cell + 1];
  for (std::size_t cell = 0; cell < cells; ++cell) start_[cell + 1] += start_[cell];
  order_.resize(points.size());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) order_[next[cell_of[i]]++] = static_cast<std::uint32_t>(i);
  x_.resize(points.size());
  y_.resize(points.size());
  z_.resize(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, points.size(), 16384}, [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Eigen::Vector3f& p = points[order_[i]];
      x_[i] = p.x();
      y_[i] = p.y();
      z_[i] = p.z();
    }
  });
}

float cell_for_count(std::span<const Eigen::Vector3f> points, double count) {
  if (points.size() < 2) return 1.0F;
  // Points per occupied cell of a trial grid, times the area of such a cell, gives the density of the
  // surface.
  const Bounds bounds = bounds_of(points);
  const float extent = std::max((bounds.high - bounds.low).maxCoeff(), 1e-3F);
  const float trial_mm = extent / 64.0F;
  std::vector<bool> seen(65ULL * 65ULL * 65ULL, false);
  std::size_t occupied = 0;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3i cell = ((p - bounds.low) / trial_mm).cast<int>().cwiseMin(64);
    const auto i = static_cast<std::size_t>((cell.z() * 65 + cell.y()) * 65 + cell.x());
    if (!seen[i]) ++occupied;
    seen[i] = true;
  }
  // A surface crosses about 1.5 times as many cells as its area has cell faces.
  const double area_mm2 =
      static_cast<double>(occupied) * static_cast<double>(trial_mm) * static_cast<double>(trial_mm) / 1.5;
  return static_cast<float>(std::sqrt(count * area_mm2 / static_cast<double>(points.size())));
}

}  // namespace biteline::published
