// SPDX-License-Identifier: MIT
#include <memory>
#include <small_gicp/ann/kdtree.hpp>
#include <small_gicp/factors/gicp_factor.hpp>
#include <small_gicp/points/point_cloud.hpp>
#include <small_gicp/registration/reduction.hpp>
#include <small_gicp/registration/registration.hpp>
#include <small_gicp/util/downsampling.hpp>
#include <small_gicp/util/normal_estimation.hpp>
#include <vector>

#include "tests/bench/transfer/peers.hpp"

namespace biteline::bench::peers {
namespace {

using Cloud = small_gicp::PointCloud;
using Tree = small_gicp::KdTree<Cloud>;

struct Prepared {
  std::shared_ptr<Cloud> cloud;
  std::shared_ptr<Tree> tree;
};

Prepared prepared(std::span<const Eigen::Vector3f> points, float voxel_mm) {
  constexpr int k_neighbours = 10;  // its own default
  std::vector<Eigen::Vector4f> all;
  all.reserve(points.size());
  for (const Eigen::Vector3f& p : points) all.emplace_back(p.x(), p.y(), p.z(), 1.0F);
  Prepared out;
  out.cloud = small_gicp::voxelgrid_sampling(Cloud{all}, voxel_mm);
  out.tree = std::make_shared<Tree>(out.cloud);
  small_gicp::estimate_covariances(*out.cloud, *out.tree, k_neighbours);
  return out;
}

}  // namespace

bool has_small_gicp() {
  return true;
}

Eigen::Isometry3d small_gicp_align(const Problem& problem) {
  const Prepared source = prepared(problem.source, problem.voxel_mm),
                 target = prepared(problem.target, problem.voxel_mm);
  small_gicp::Registration<small_gicp::GICPFactor, small_gicp::SerialReduction> registration;
  registration.rejector.max_dist_sq = problem.reach_mm * problem.reach_mm;
  // Its defaults are for metres and vehicles: a micrometre and a hundred-thousandth of a degree.
  registration.criteria.translation_eps = 1e-3;
  registration.criteria.rotation_eps = 2e-7;
  registration.optimizer.max_iterations = problem.max_iterations;
  return registration.align(*target.cloud, *source.cloud, *target.tree, Eigen::Isometry3d::Identity())
      .T_target_source;
}

}  // namespace biteline::bench::peers
