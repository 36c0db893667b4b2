// SPDX-License-Identifier: MIT
#pragma once
/// \file The public libraries that registration is compared with.  Each may be missing from a build; the
/// bench says so.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

namespace biteline::bench::peers {

struct Problem {
  std::span<const Eigen::Vector3f> source;
  std::span<const Eigen::Vector3f> target;
  float voxel_mm{2};
  double reach_mm{10};
  int max_iterations{40};
};

[[nodiscard]] bool has_pcl();
/// VoxelGrid, NormalEstimation with 20 neighbours, IterativeClosestPointWithNormals (point to plane).
[[nodiscard]] Eigen::Isometry3d pcl_align(const Problem& problem);

[[nodiscard]] bool has_open3d();
/// VoxelDownSample, EstimateNormals with 20 neighbours, RegistrationICP point to plane.
[[nodiscard]] Eigen::Isometry3d open3d_align(const Problem& problem);

[[nodiscard]] bool has_small_gicp();
/// voxelgrid_sampling, estimate_covariances with 10 neighbours, Registration of GICPFactor; its serial
/// functions.
[[nodiscard]] Eigen::Isometry3d small_gicp_align(const Problem& problem);

}  // namespace biteline::bench::peers
