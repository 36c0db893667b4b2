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
  std::array<std::size_t, Batch::k_lanes> count{};
};

/// Neighbours of one point; beyond what a batch holds every n-th is taken, so that the whole disc stays covered.
float gather(const NeighbourGrid& grid, std::uint32_t index, const CurvatureConfig& config, std::vector<NeighbourGrid::Hit>& hits) {
  hits.clear();
  if (config.neighbours > 0) return std::max(grid.nearest(index, config.neighbours, hits), 1e-6F);
  grid.within(index, config.radius_mm, hits);
  if (hits.size() > Batch::k_most_neighbours) {
    for (std::size_t j = 0; j < Batch::k_most_neighbours; ++j) hits[j] = hits[j * hits.size() / Batch::k_most_neighbours];
    hits.resize(Batch::k_most_neighbours);
  }
  return config.radius_mm;
}

/// Puts the neighbourhoods of up to k_lanes points, from `first` on, into the batch; with normals when there are any.
std::size_t fill(const NeighbourGrid& grid, std::size_t first, std::size_t end, std::span<const Eigen::Vector3f> normals,
                 const CurvatureConfig& config, Scratch& scratch) {
  Batch& batch = scratch.batch;
  const std::size_t lanes = std::min(Batch::k_lanes, end - first);
  batch.rows = 0;
  scratch.count.fill(0);
  const float fall = config.weight_ratio > 0 ? 0.5F / (config.weight_ratio * config.weight_ratio) : 0.0F;
  std::size_t shortest = Batch::k_most_neighbours;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const auto index = static_cast<std::uint32_t>(first + lane);
    const float radius = gather(grid, index, config, scratch.hits);
    const float inverse = 1.0F / radius;
    scratch.radius_mm[lane] = radius;
    scratch.count[lane] = scratch.hits.size();
    shortest = std::min(shortest, scratch.hits.size());
    const float px = grid.x()[index];
    const float py = grid.y()[index];
    const float pz = grid.z()[index];
    for (std::size_t j = 0; j < scratch.hits.size(); ++j) {
      const std::uint32_t other = scratch.hits[j].index;
      batch.x[j][lane] = (grid.x()[other] - px) * inverse;
      batch.y[j][lane] = (grid.y()[other] - py) * inverse;
      batch.z[j][lane] = (grid.z()[other] - pz) * inverse;
      batch.weight[j][lane] = scratch.hits[j].distance2_mm2 * inverse * inverse;
      if (!normals.empty()) {
        batch.nx[j][lane] = normals[other].x();
        batch.ny[j][lane] = normals[other].y();
        batch.nz[j][lane] = normals[other].z();
      }
    }
    // exp(-8 t) as the eighth power of a short series' reciprocal: to 0.1 %, without a call per neighbour.
    for (std::size_t j = 0; j < scratch.hits.size(); ++j) {
      const float t = fall * batch.weight[j][lane] * 0.125F;
      const float e = 1.0F / (1.0F + t * (1.0F + t * (0.5F + t * 0.16666667F)));
      const float e2 = e * e;
      batch.weight[j][lane] = e2 * e2 * e2 * e2;
    }
    batch.rows = std::max(batch.rows, scratch.hits.size());
  }
  if (lanes < Batch::k_lanes) shortest = 0;
  // What the fuller lanes have beyond this lane's neighbours counts nothing here.
  for (std::size_t lane = 0; shortest < batch.rows && lane < Batch::k_lanes; ++lane) {
    for (std::size_t j = scratch.count[lane]; j < batch.rows; ++j) {
      batch.x[j][lane] = batch.y[j][lane] = batch.z[j][lane] = batch.weight[j][lane] = 0.0F;
      batch.nx[j][lane] = batch.ny[j][lane] = batch.nz[j][lane] = 0.0F;
    }
  }
  return lanes;
}

}  // namespace

Curvature estimate_curvature(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> outward, const CurvatureConfig& config) {
  BITELINE_EXPECTS(outward.empty() || outward.size() == points.size());
  BITELINE_EXPECTS(config.neighbours <= Batch::k_most_neighbours);
  Curvature result;
  result.normal.resize(points.size());
  result.mean_per_mm.assign(points.size(), 0.0F);
  result.gaussian_per_mm2.assign(points.size(), 0.0F);
  result.trusted.assign(points.size(), 0);
  if (points.empty()) return result;

  const float cell_mm = config.neighbours > 0 ? cell_for_count(points, static_cast<double>(config.neighbours) / 4.0) : config.radius_mm;
  const NeighbourGrid grid{points, {.cell_mm = cell_mm}};
  const std::vector<std::uint32_t>& order = grid.order();
  std::vector<Eigen::Vector3f> normals(points.size());  // grid order
  tbb::enumerable_thread_specific<Scratch> scratches;
  constexpr std::size_t k_grain = 64 * Batch::k_lanes;

  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, points.size(), k_grain}, [&](const auto& range) {
    Scratch& scratch = scratches.local();
    for (std::size_t first = range.begin(); first < range.end(); first += Batch::k_lanes) {
      const std::size_t lanes = fill(grid, first, range.end(), {}, config, scratch);
      fit_planes(scratch.batch);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        Eigen::Vector3f normal{scratch.batch.out_nx[lane], scratch.batch.out_ny[lane], scratch.batch.out_nz[lane]};
        if (!outward.empty() && normal.dot(outward[order[first + lane]]) < 0) normal = -normal;
        normals[first + lane] = normal;
      }
    }
  });
  if (outward.empty()) orient_consistently(grid, normals);

  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, points.size(), k_grain}, [&](const auto& range) {
    Scratch& scratch = scratches.local();
    for (std::size_t first = range.begin(); first < range.end(); first += Batch::k_lanes) {
      const std::size_t lanes = fill(grid, first, range.end(), normals, config, scratch);
      fit_level_sets(scratch.batch, config.solver, config.offset_ratio);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t i = order[first + lane];
        result.normal[i] = normals[first + lane];
        if (scratch.count[lane] < k_least_neighbours || scratch.batch.trust[lane] == 0.0F) continue;
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
