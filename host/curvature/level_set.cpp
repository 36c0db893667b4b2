// SPDX-License-Identifier: MIT
#include "host/curvature/level_set.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "common/core/contracts.hpp"
#include "host/curvature/orient.hpp"

namespace biteline::curvature {

namespace {

constexpr std::size_t k_least_neighbours = 8;  // 24 equations for ten unknowns

struct Scratch {
  Batch batch;
  std::vector<NeighbourGrid::Hit> hits;
  std::array<float, Batch::k_lanes> radius_mm{};
};

/// The neighbours found for the normals, kept for the curvature while that costs at most 100 bytes per point.
struct Kept {
  static constexpr std::size_t k_most = 24;
  std::size_t per_point{0};          ///< 0: nothing is kept
  std::vector<std::uint32_t> index;  ///< per_point each
  std::vector<float> radius_mm;
};

/// Neighbours of one point; beyond what a batch holds every n-th is taken, so that the whole disc stays
/// covered.
float gather(const NeighbourGrid& grid, std::uint32_t index, const CurvatureConfig& config,
             std::vector<NeighbourGrid::Hit>& hits) {
  hits.clear();
  if (config.neighbours > 0) return std::max(grid.nearest(index, config.neighbours, hits), 1e-6F);
  grid.within(index, config.radius_mm, hits);
  if (hits.size() > Batch::k_most_neighbours) {
    for (std::size_t j = 0; j < Batch::k_most_neighbours; ++j)
      hits[j] = hits[j * hits.size() / Batch::k_most_neighbours];
    hits.resize(Batch::k_most_neighbours);
  }
  return config.radius_mm;
}

class Filler {
 public:
  Filler(const NeighbourGrid& grid, const CurvatureConfig& config, Scratch& scratch)
      : grid_{grid}, config_{config}, scratch_{scratch} {
    scratch.batch.fall = config.weight_ratio > 0 ? 0.5F / (config.weight_ratio * config.weight_ratio) : 0.0F;
  }

  /// Searches the neighbours of up to k_lanes points from `first` on, and keeps them when `kept` wants them.
  std::size_t search(std::size_t first, std::size_t end, std::span<const Eigen::Vector3f> normals,
                     Kept& kept) {
    const std::size_t lanes = begin(first, end);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const auto index = static_cast<std::uint32_t>(first + lane);
      scratch_.radius_mm[lane] = gather(grid_, index, config_, scratch_.hits);
      if (kept.per_point > 0) {
        kept.radius_mm[index] = scratch_.radius_mm[lane];
        for (std::size_t j = 0; j < kept.per_point; ++j)
          kept.index[index * kept.per_point + j] = scratch_.hits[std::min(j, scratch_.hits.size() - 1)].index;
      }
      put(lane, index, scratch_.hits.size(), normals, [&](std::size_t j) { return scratch_.hits[j].index; });
    }
    return lanes;
  }

  /// The same from what was kept.
  std::size_t recall(std::size_t first, std::size_t end, std::span<const Eigen::Vector3f> normals,
                     const Kept& kept) {
    const std::size_t lanes = begin(first, end);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const auto index = static_cast<std::uint32_t>(first + lane);
      scratch_.radius_mm[lane] = kept.radius_mm[index];
      const std::uint32_t* list = kept.index.data() + index * kept.per_point;
      put(lane, index, kept.per_point, normals, [&](std::size_t j) { return list[j]; });
    }
    return lanes;
  }

 private:
  std::size_t begin(std::size_t first, std::size_t end) {
    scratch_.batch.rows = 0;
    scratch_.batch.count.fill(0.0F);
    return std::min(Batch::k_lanes, end - first);
  }

  template <class IndexOf>
  void put(std::size_t lane, std::uint32_t index, std::size_t count, std::span<const Eigen::Vector3f> normals,
           IndexOf&& index_of) {
    Batch& batch = scratch_.batch;
    const float inverse = 1.0F / scratch_.radius_mm[lane];
    const float px = grid_.x()[index];
    const float py = grid_.y()[index];
    const float pz = grid_.z()[index];
    for (std::size_t j = 0; j < count; ++j) {
      const std::uint32_t other = index_of(j);
      batch.x[j][lane] = (grid_.x()[other] - px) * inverse;
      batch.y[j][lane] = (grid_.y()[other] - py) * inverse;
      batch.z[j][lane] = (grid_.z()[other] - pz) * inverse;
      if (normals.empty()) continue;
      batch.nx[j][lane] = normals[other].x();
      batch.ny[j][lane] = normals[other].y();
      batch.nz[j][lane] = normals[other].z();
    }
    batch.count[lane] = static_cast<float>(count);
    batch.rows = std::max(batch.rows, count);
  }

  const NeighbourGrid& grid_;
  const CurvatureConfig& config_;
  Scratch& scratch_;
};

}  // namespace

Curvature estimate_curvature(std::span<const Eigen::Vector3f> points,
                             std::span<const Eigen::Vector3f> outward, const CurvatureConfig& config) {
  BITELINE_EXPECTS(outward.empty() || outward.size() == points.size());
  BITELINE_EXPECTS(config.neighbours <= Batch::k_most_neighbours);
  Curvature result;
  result.normal.resize(points.size());
  result.mean_per_mm.assign(points.size(), 0.0F);
  result.gaussian_per_mm2.assign(points.size(), 0.0F);
  result.trusted.assign(points.size(), 0);
  if (points.empty()) return result;

  const float cell_mm = config.neighbours > 0
                            ? cell_for_count(points, static_cast<double>(config.neighbours) / 2.2)
                            : config.radius_mm;
  const NeighbourGrid grid{points, {.cell_mm = cell_mm}};
  const std::vector<std::uint32_t>& order = grid.order();
  std::vector<Eigen::Vector3f> normals(points.size());  // grid order
  Kept kept;
  if (config.neighbours > 0 && config.neighbours <= Kept::k_most && points.size() >= config.neighbours) {
    kept.per_point = config.neighbours;
    kept.index.resize(points.size() * kept.per_point);
    kept.radius_mm.resize(points.size());
  }
  tbb::enumerable_thread_specific<Scratch> scratches;
  constexpr std::size_t k_grain = 64 * Batch::k_lanes;

  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, points.size(), k_grain}, [&](const auto& range) {
    Scratch& scratch = scratches.local();
    Filler filler{grid, config, scratch};
    for (std::size_t first = range.begin(); first < range.end(); first += Batch::k_lanes) {
      const std::size_t lanes = filler.search(first, range.end(), {}, kept);
      fit_planes(scratch.batch);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        Eigen::Vector3f normal{scratch.batch.out_nx[lane], scratch.batch.out_ny[lane],
                               scratch.batch.out_nz[lane]};
        if (!outward.empty() && normal.dot(outward[order[first + lane]]) < 0) normal = -normal;
        normals[first + lane] = normal;
      }
    }
  });
  if (outward.empty()) orient_consistently(grid, normals);

  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, points.size(), k_grain}, [&](const auto& range) {
    Scratch& scratch = scratches.local();
    Filler filler{grid, config, scratch};
    Kept none;
    for (std::size_t first = range.begin(); first < range.end(); first += Batch::k_lanes) {
      const std::size_t lanes = kept.per_point > 0 ? filler.recall(first, range.end(), normals, kept)
                                                   : filler.search(first, range.end(), normals, none);
      fit_level_sets(scratch.batch, config.solver, config.offset_ratio);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t i = order[first + lane];
        result.normal[i] = normals[first + lane];
        if (scratch.batch.count[lane] < static_cast<float>(k_least_neighbours) ||
            scratch.batch.trust[lane] == 0.0F)
          continue;
        const float inverse = 1.0F / scratch.radius_mm[lane];
        result.mean_per_mm[i] = scratch.batch.mean[lane] * inverse;
        result.gaussian_per_mm2[i] = scratch.batch.gaussian[lane] * inverse * inverse;
        result.trusted[i] = 1;
      }
    }
  });
  return result;
}

Principal principal(float mean_per_mm, float gaussian_per_mm2) {
  const float root = std::sqrt(std::max(0.0F, mean_per_mm * mean_per_mm - gaussian_per_mm2));
  return {mean_per_mm + root, mean_per_mm - root};
}

}  // namespace biteline::curvature
