// SPDX-License-Identifier: MIT
#pragma once
/// \file The public libraries that ours is compared with.  Each may be missing from a build; the bench then
/// says so.

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace biteline::bench::peers {

struct Values {
  std::vector<float> mean_per_mm;
  std::vector<float> gaussian_per_mm2;
};

[[nodiscard]] bool has_pcl();
/// NormalEstimation, then PrincipalCurvaturesEstimation; by radius when `radius_mm` > 0.
[[nodiscard]] Values pcl_curvature(std::span<const Eigen::Vector3f> points, std::size_t neighbours,
                                   float radius_mm = 0);

[[nodiscard]] bool has_cgal();
/// kd-tree search, then a jet of degree 2 per point (Monge_via_jet_fitting).  `outward` settles the sign.
[[nodiscard]] Values cgal_curvature(std::span<const Eigen::Vector3f> points, std::size_t neighbours,
                                    float radius_mm = 0, std::span<const Eigen::Vector3f> outward = {});

}  // namespace biteline::bench::peers
