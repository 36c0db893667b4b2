// SPDX-License-Identifier: MIT
#include "host/bite_line/published/level_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "common/core/contracts.hpp"
#include "host/bite_line/published/neighbour_search.hpp"
#include "host/bite_line/published/orient.hpp"

namespace biteline::published {

namespace {

constexpr std::size_t k_least_neighbours = 8;  // 24 equations for ten unknowns

struct Scratch {
  explicit Scratch(const NeighbourGrid& grid) : search{grid} {}
  NeighbourSearch search;
  Batch batch;
  std::vector<std::uint32_t> spread;
};

/// Whose neighbourhood a batch's lane holds.
struct Neighbourhood {
  std::span<const std::uint32_t> index;  ///< in grid order
  float radius_mm;
};

/// The neighbours found for the normals, kept for the curvature while that costs at most 100 bytes per point.
struct Kept {
  static constexpr std::size_t k_most = 24;
  std::size_t per_point{0};          ///< 0: nothing is kept
  std::vector<std::uint32_t> index;  ///< per_point each
  std::vector<float> radius_mm;

  [[nodiscard]] Neighbourhood of(std::uint32_t point) const {
    return {{index.data() + point * per_point, per_point}, radius_mm[point]};
  }
  void keep(std::uint32_t point, const Neighbourhood& found) {
    if (per_point == 0) return;
    std::copy(found.index.begin(), found.index.end(), index.begin() + point * per_point);
    radius_mm[point] = found.radius_mm;
  }
};

/// Neighbours of one point; beyond what a batch holds every n-th is taken, so that the whole disc stays
/// covered.
Neighbourhood neighbourhood(std::uint32_t point, const CurvatureConfig& config, Scratch& scratch) {
  if (config.neighbours > 0) {
    const NeighbourSearch::Nearest nearest = scratch.search.nearest(point, config.neighbours);
    return {nearest.index, std::max(nearest.farthest_mm, 1e-6F)};
  }
  const std::span<const std::uint32_t> all = scratch.search.within(point, config.radius_mm);
  if (all.size() <= Batch::k_most_neighbours) return {all, config.radius_mm};
  scratch.spread.resize(Batch::k_most_neighbours);
  for (std::size_t j = 0; j < scratch.spread.size(); ++j)
    scratch.spread[j] = all[j * all.size() / scratch.spread.size()];
  return {scratch.spread, config.radius_mm};
}

/// Puts a neighbourhood into a lane of the batch, relative to its point and divided by its radius; `normals`
/// may be empty.
void put(const NeighbourGrid& grid, std::uint32_t point, const Neighbourhood& around,
         std::span<const Eigen::Vector3f> normals, std::size_t lane, Batch& batch) {
  const float inverse = 1.0F / around.radius_mm;
  const float px = grid.x()[point];
  const float py = grid.y()[point];
  const float pz = grid.z()[point];
  for (std::size_t j = 0; j < around.index.size(); ++j) {
    const std::uint32_t other = around.index[j];
    batch.x[j][lane] = (grid.x()[other] - px) * inverse;
    batch.y[j][lane] = (grid.y()[other] - py) * inverse;
    batch.z[j][lane] = (grid.z()[other] - pz) * inverse;
    if (normals.empty()) continue;
    batch.nx[j][lane] = normals[other].x();
    batch.ny[j][lane] = normals[other].y();
    batch.nz[j][lane] = normals[other].z();
  }
  batch.count[lane] = static_cast<float>(around.index.size());
  batch.rows = std::max(batch.rows, around.index.size());
}

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
  tbb::enumerable_thread_specific<Scratch> scratches{[&] { return Scratch{grid}; }};
  /// Fills batch after batch with what `neighbours_of(point, scratch)` gives, and hands each on.
  const auto for_each_batch = [&](std::span<const Eigen::Vector3f> with_normals, auto&& neighbours_of,
                                  auto&& use) {
    constexpr std::size_t k_grain = 64 * Batch::k_lanes;
    tbb::parallel_for(tbb::blocked_range<std::size_t>{0, points.size(), k_grain}, [&](const auto& range) {
      Scratch& scratch = scratches.local();
      scratch.batch.fall =
          config.weight_ratio > 0 ? 0.5F / (config.weight_ratio * config.weight_ratio) : 0.0F;
      for (std::size_t first = range.begin(); first < range.end(); first += Batch::k_lanes) {
        const std::size_t lanes = std::min(Batch::k_lanes, range.end() - first);
        std::array<float, Batch::k_lanes> radius_mm{};
        scratch.batch.rows = 0;
        scratch.batch.count.fill(0.0F);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          const auto point = static_cast<std::uint32_t>(first + lane);
          const Neighbourhood around = neighbours_of(point, scratch);
          radius_mm[lane] = around.radius_mm;
          put(grid, point, around, with_normals, lane, scratch.batch);
        }
        use(first, lanes, radius_mm, scratch.batch);
      }
    });
  };
  for_each_batch(
      {},
      [&](std::uint32_t point, Scratch& scratch) {
        const Neighbourhood found = neighbourhood(point, config, scratch);
        kept.keep(point, found);
        return found;
      },
      [&](std::size_t first, std::size_t lanes, const auto&, Batch& batch) {
        fit_planes(batch);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          Eigen::Vector3f normal{batch.out_nx[lane], batch.out_ny[lane], batch.out_nz[lane]};
          if (!outward.empty() && normal.dot(outward[order[first + lane]]) < 0) normal = -normal;
          normals[first + lane] = normal;
        }
      });
  if (outward.empty()) orient_consistently(grid, normals);

  for_each_batch(
      normals,
      [&](std::uint32_t point, Scratch& scratch) {
        return kept.per_point > 0 ? kept.of(point) : neighbourhood(point, config, scratch);
      },
      [&](std::size_t first, std::size_t lanes, const auto& radius_mm, Batch& batch) {
        fit_level_sets(batch, config.solver, config.offset_ratio);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          const std::size_t i = order[first + lane];
          result.normal[i] = normals[first + lane];
          if (batch.count[lane] < static_cast<float>(k_least_neighbours) || batch.trust[lane] == 0.0F)
            continue;
          const float inverse = 1.0F / radius_mm[lane];
          result.mean_per_mm[i] = batch.mean[lane] * inverse;
          result.gaussian_per_mm2[i] = batch.gaussian[lane] * inverse * inverse;
          result.trusted[i] = 1;
        }
      });
  return result;
}

Principal principal(float mean_per_mm, float gaussian_per_mm2) {
  const float root = std::sqrt(std::max(0.0F, mean_per_mm * mean_per_mm - gaussian_per_mm2));
  return {mean_per_mm + root, mean_per_mm - root};
}

}  // namespace biteline::published
