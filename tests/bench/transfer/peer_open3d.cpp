// SPDX-License-Identifier: MIT
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/Registration.h>

#include "tests/bench/transfer/peers.hpp"

namespace biteline::bench::peers {
namespace {

std::shared_ptr<open3d::geometry::PointCloud> prepared(std::span<const Eigen::Vector3f> points,
                                                       float voxel_mm) {
  open3d::geometry::PointCloud all;
  all.points_.reserve(points.size());
  for (const Eigen::Vector3f& p : points) all.points_.push_back(p.cast<double>());
  const auto thin = all.VoxelDownSample(voxel_mm);
  thin->EstimateNormals(open3d::geometry::KDTreeSearchParamKNN(20));
  return thin;
}

}  // namespace

bool has_open3d() {
  return true;
}

Eigen::Isometry3d open3d_align(const Problem& problem) {
  namespace reg = open3d::pipelines::registration;
  const auto source = prepared(problem.source, problem.voxel_mm),
             target = prepared(problem.target, problem.voxel_mm);
  const reg::RegistrationResult result =
      reg::RegistrationICP(*source, *target, problem.reach_mm, Eigen::Matrix4d::Identity(),
                           reg::TransformationEstimationPointToPlane(),
                           reg::ICPConvergenceCriteria(1e-9, 1e-9, problem.max_iterations));
  Eigen::Isometry3d T;
  T.matrix() = result.transformation_;
  return T;
}

}  // namespace biteline::bench::peers
