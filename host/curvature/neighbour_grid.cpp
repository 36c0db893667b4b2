// SPDX-License-Identifier: MIT
#include "host/curvature/neighbour_grid.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace biteline::curvature {

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
      const Eigen::Vector3i cell =
          ((points[i] - origin_) * inverse_mm_).cast<int>().cwiseMin(size_ - Eigen::Vector3i::Ones());
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

void NeighbourGrid::within(std::uint32_t index, float radius_mm, std::vector<Hit>& hits) const {
  const float px = x_[index];
  const float py = y_[index];
  const float pz = z_[index];
  const auto low = [&](float p, int axis) {
    return std::max(0, static_cast<int>((p - radius_mm - origin_[axis]) * inverse_mm_));
  };
  const auto high = [&](float p, int axis) {
    return std::min(size_[axis] - 1, static_cast<int>((p + radius_mm - origin_[axis]) * inverse_mm_));
  };
  const int x0 = low(px, 0);
  const int x1 = high(px, 0);
  const float r2 = radius_mm * radius_mm;
  for (int cz = low(pz, 2); cz <= high(pz, 2); ++cz) {
    for (int cy = low(py, 1); cy <= high(py, 1); ++cy) {
      const auto row = static_cast<std::size_t>((cz * size_.y() + cy) * size_.x());
      const std::uint32_t begin = start_[row + static_cast<std::size_t>(x0)];
      const std::uint32_t end = start_[row + static_cast<std::size_t>(x1) + 1];
      // Written without a branch: a neighbour or not is a coin toss.
      std::size_t count = hits.size();
      hits.resize(count + (end - begin));
      Hit* out = hits.data();
      for (std::uint32_t i = begin; i < end; ++i) {
        const float dx = x_[i] - px;
        const float dy = y_[i] - py;
        const float dz = z_[i] - pz;
        const float d2 = dx * dx + dy * dy + dz * dz;
        out[count] = {d2, i};
        count += d2 <= r2 ? 1U : 0U;
      }
      hits.resize(count);
    }
  }
}

float NeighbourGrid::nearest(std::uint32_t index, std::size_t count, std::vector<Hit>& hits) const {
  count = std::min(count, size());
  float radius_mm = cell_mm_;
  for (int widen = 0; widen < 24; ++widen) {
    hits.clear();
    within(index, radius_mm, hits);
    if (hits.size() >= count) break;
    radius_mm *= 1.6F;
  }
  const auto nearer = [](const Hit& a, const Hit& b) { return a.distance2_mm2 < b.distance2_mm2; };
  if (hits.size() > count) {
    std::nth_element(hits.begin(), hits.begin() + static_cast<std::ptrdiff_t>(count - 1), hits.end(), nearer);
    hits.resize(count);
  }
  float farthest = 0;
  for (const Hit& hit : hits) farthest = std::max(farthest, hit.distance2_mm2);
  return std::sqrt(farthest);
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

}  // namespace biteline::curvature
