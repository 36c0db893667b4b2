// SPDX-License-Identifier: MIT
#include "host/transfer/align/surfels.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "host/transfer/align/voxel_map.hpp"

namespace biteline::transfer {
namespace {

constexpr float k_min_points = 8;  // a plane through fewer noisy points says little
// Least to middle eigenvalue of the neighbourhood's covariance: a surface has about 0, a blob of stray
// points 1.
constexpr float k_max_thickness_ratio = 0.3F;

/// Count, sum and second moments of points, relative to an origin shared by all voxels.
struct Moments {
  float count{0};
  Eigen::Vector3f sum{Eigen::Vector3f::Zero()};
  Eigen::Matrix3f outer{Eigen::Matrix3f::Zero()};  ///< about the voxel's own first point, see `anchor`
  Eigen::Vector3f anchor{Eigen::Vector3f::Zero()};

  void add(const Eigen::Vector3f& point) {
    if (count == 0) anchor = point;
    const Eigen::Vector3f d = point - anchor;
    count += 1;
    sum += d;
    // Lower triangle only; the eigen solver reads nothing else.
    outer(0, 0) += d.x() * d.x();
    outer(1, 0) += d.y() * d.x();
    outer(1, 1) += d.y() * d.y();
    outer(2, 0) += d.z() * d.x();
    outer(2, 1) += d.z() * d.y();
    outer(2, 2) += d.z() * d.z();
  }

  [[nodiscard]] Eigen::Vector3f mean() const { return anchor + sum / count; }
};

/// Adds the moments of `part` about `centre`.
void add_about(const Moments& part, const Eigen::Vector3f& centre, Moments& total) {
  const Eigen::Vector3f a = part.anchor - centre;
  total.count += part.count;
  total.sum += part.sum + part.count * a;
  total.outer += part.outer;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column <= row; ++column) {
      total.outer(row, column) +=
          a[row] * part.sum[column] + part.sum[row] * a[column] + part.count * a[row] * a[column];
    }
  }
}

/// Occupied voxels in the order of their keys: z, then y, then x.
struct OrderedVoxels {
  std::vector<VoxelKey> keys;
  std::vector<Moments> moments;
};

OrderedVoxels ordered(const VoxelMap& voxels, const std::vector<Moments>& moments) {
  std::vector<std::uint32_t> order(voxels.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return voxels.keys()[i]; });
  OrderedVoxels sorted;
  sorted.keys.reserve(order.size());
  sorted.moments.reserve(order.size());
  for (const std::uint32_t i : order) {
    sorted.keys.push_back(voxels.keys()[i]);
    sorted.moments.push_back(moments[i]);
  }
  return sorted;
}

/// Sums the moments of a voxel and its 26 neighbours, voxel after voxel in the order of the keys.  The
/// neighbours stand in nine rows along x, and in each of them the place only moves on: no search.
class Neighbourhoods {
 public:
  Neighbourhoods(const OrderedVoxels& voxels, std::size_t first) : voxels_{voxels} {
    for (int row = 0; row < k_rows; ++row) {
      const auto at = std::ranges::lower_bound(voxels.keys, row_begin(voxels.keys[first], row));
      next_[static_cast<std::size_t>(row)] = static_cast<std::size_t>(at - voxels.keys.begin());
    }
  }

  /// Pre: `i` grows from call to call.
  [[nodiscard]] Moments about(std::size_t i, const Eigen::Vector3f& centre) {
    Moments total;
    for (int row = 0; row < k_rows; ++row) {
      const VoxelKey begin = row_begin(voxels_.keys[i], row), last = begin + 2;
      std::size_t& at = next_[static_cast<std::size_t>(row)];
      while (at < voxels_.keys.size() && voxels_.keys[at] < begin) ++at;
      for (std::size_t k = at; k < voxels_.keys.size() && voxels_.keys[k] <= last; ++k)
        add_about(voxels_.moments[k], centre, total);
    }
    return total;
  }

 private:
  static constexpr int k_rows = 9;
  static VoxelKey row_begin(VoxelKey key, int row) {
    return VoxelGrid::neighbour(key, -1, row % 3 - 1, row / 3 - 1);
  }

  const OrderedVoxels& voxels_;
  std::array<std::size_t, k_rows> next_{};
};

/// Across the surface that the points lie on; none where they are too few or strewn.
std::optional<Eigen::Vector3f> normal_of(const Moments& around) {
  if (around.count < k_min_points) return std::nullopt;
  const Eigen::Vector3f offset = around.sum / around.count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(around.outer / around.count - offset * offset.transpose());
  const Eigen::Vector3f& spread = solver.eigenvalues();
  if (spread[0] > k_max_thickness_ratio * spread[1]) return std::nullopt;
  return solver.eigenvectors().col(0).normalized();
}

/// The middle line of a shoe: along the longest horizontal extent, at the lower quarter of its height,
/// shortened by half its width at each end, so that the rounds of heel and toe look away from the line's
/// ends.
class MiddleLine {
 public:
  explicit MiddleLine(std::span<const Eigen::Vector3f> points) {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& p : points) mean += p;
    mean /= static_cast<float>(points.size());
    Eigen::Matrix2f covariance = Eigen::Matrix2f::Zero();
    float height_variance = 0;
    for (const Eigen::Vector3f& p : points) {
      const Eigen::Vector3f d = p - mean;
      covariance += d.head<2>() * d.head<2>().transpose();
      height_variance += d.z() * d.z();
    }
    const float count = static_cast<float>(points.size());
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2f> solver;
    solver.computeDirect(covariance / count);
    // From standard deviations and not from extremes, which one stray point would move.  An even spread over
    // a length L has L / sqrt(12); an outline's sides lie near their extreme.
    const float half_length_mm = 1.7F * std::sqrt(std::max(0.0F, solver.eigenvalues()[1]));
    const float half_width_mm = 1.3F * std::sqrt(std::max(0.0F, solver.eigenvalues()[0]));
    along_ = {solver.eigenvectors()(0, 1), solver.eigenvectors()(1, 1), 0};
    origin_ = mean - 0.87F * std::sqrt(height_variance / count) * Eigen::Vector3f::UnitZ();
    half_mm_ = std::max(0.0F, half_length_mm - half_width_mm);
  }

  /// True when `normal` at `point` looks away from the line.
  [[nodiscard]] bool is_outward(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const {
    const float at = std::clamp(along_.dot(point - origin_), -half_mm_, half_mm_);
    return normal.dot(point - origin_ - at * along_) >= 0;
  }

 private:
  Eigen::Vector3f origin_, along_;
  float half_mm_{0};
};

void turn_outward(Surfels& surfels) {
  if (surfels.positions.empty()) return;
  const MiddleLine line{surfels.positions};
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    if (!line.is_outward(surfels.positions[i], surfels.normals[i])) surfels.normals[i] = -surfels.normals[i];
  }
}

}  // namespace

Surfels surfels_of(std::span<const Eigen::Vector3f> points, float pitch_mm) {
  const VoxelGrid grid{pitch_mm};
  VoxelMap voxels;
  std::vector<Moments> moments;
  for (const Eigen::Vector3f& point : points) {
    const std::uint32_t at = voxels.number(grid.key(point));
    if (at == moments.size()) moments.emplace_back();
    moments[at].add(point);
  }

  const OrderedVoxels sorted = ordered(voxels, moments);
  Surfels surfels{.pitch_mm = pitch_mm};
  surfels.positions.reserve(voxels.size());
  surfels.normals.reserve(voxels.size());
  std::vector<std::optional<Eigen::Vector3f>> normals(voxels.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, voxels.size(), 1024}, [&](const auto& range) {
    Neighbourhoods around{sorted, range.begin()};
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      normals[i] = normal_of(around.about(i, sorted.moments[i].mean()));
  });
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (!normals[i]) continue;
    surfels.positions.push_back(sorted.moments[i].mean());
    surfels.normals.push_back(*normals[i]);
  }
  turn_outward(surfels);
  return surfels;
}

Surfels coarsened(const Surfels& fine, float pitch_mm) {
  const VoxelGrid grid{pitch_mm};
  VoxelMap voxels;
  Surfels coarse{.pitch_mm = pitch_mm};
  std::vector<float> counts;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const std::uint32_t at = voxels.number(grid.key(fine.positions[i]));
    if (at == counts.size()) {
      counts.push_back(0);
      coarse.positions.emplace_back(Eigen::Vector3f::Zero());
      coarse.normals.emplace_back(Eigen::Vector3f::Zero());
      if (!fine.feet.empty()) coarse.feet.emplace_back();
    }
    counts[at] += 1;
    coarse.positions[at] += fine.positions[i];
    coarse.normals[at] += fine.normals[i];
    if (!fine.feet.empty()) {
      coarse.feet[at].place += fine.feet[i].place;
      coarse.feet[at].outward += fine.feet[i].outward;
    }
  }
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    coarse.positions[i] /= counts[i];
    if (!coarse.feet.empty()) {
      coarse.feet[i].place /= counts[i];
      coarse.feet[i].outward.normalize();
    }
    coarse.normals[i]
        .normalize();  // stays zero where two sides of a thin sheet share a voxel: then nothing matches it
  }
  return coarse;
}

}  // namespace biteline::transfer
