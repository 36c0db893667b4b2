// SPDX-License-Identifier: MIT
#pragma once
/// \file The point cloud of one scan, in base.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace biteline::cloud {

/// Points in base, mm, single precision (0.00006 mm at 1 m).  Structure of arrays; every array but `points`
/// is either empty or as long as `points`.  Scan order when `profile` and `column` are there: rising profile,
/// then column.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< outward, unit length
  std::vector<float> mean_per_mm;        ///< mean curvature, convex > 0; NaN where it could not be told
  std::vector<std::uint32_t> profile;    ///< profile's sequence number
  std::vector<std::uint16_t> column;     ///< image column
  std::vector<float> sigma_mm;           ///< standard deviation along the ray
  std::vector<std::uint16_t> flags;      ///< profile::PointFlag

  [[nodiscard]] std::size_t size() const { return points.size(); }
  [[nodiscard]] bool organised() const { return !profile.empty() && !column.empty(); }
};

}  // namespace biteline::cloud
