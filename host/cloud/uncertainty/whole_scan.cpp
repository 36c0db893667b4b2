// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/whole_scan.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace biteline::uncertainty {

Mat3 WholeScan::covariance_mm2(const Vec3& point_base) const {
  const double arm_mm = arm ? arm->sigma_mm_at(point_base) : 0;
  return head ? head->covariance_mm2(point_base, arm_mm) : Mat3(arm_mm * arm_mm * Mat3::Identity());
}

SpreadAlong::SpreadAlong(const WholeScan& scan, std::size_t count,
                         const std::function<Vec3(std::size_t)>& point)
    : count_{count} {
  if (!scan.known() || count == 0) return;
  constexpr std::size_t k_points_apart = 8;
  nodes_.resize(std::max<std::size_t>(1, count_ / k_points_apart));
  tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t k) {
    nodes_[k] = scan.covariance_mm2(point(k * count_ / nodes_.size()));
  });
}

Mat3 SpreadAlong::at(std::size_t point) const {
  if (nodes_.empty()) return Mat3::Zero();
  const double place = static_cast<double>(point * nodes_.size()) / static_cast<double>(count_);
  const auto before = static_cast<std::size_t>(place) % nodes_.size();
  const double fraction = place - std::floor(place);
  return (1 - fraction) * nodes_[before] + fraction * nodes_[(before + 1) % nodes_.size()];
}

Eigen::Matrix2d across(const Mat3& covariance_mm2, const Vec3& tangent, const Vec3& up) {
  Eigen::Matrix<double, 3, 2> plane;
  const Vec3 level = tangent.cross(up);
  // A line that stands upright has no level direction of its own: any one square to it will do.
  constexpr double k_upright = 1e-6;
  plane.col(0) = level.norm() > k_upright ? level.normalized() : tangent.unitOrthogonal();
  plane.col(1) = plane.col(0).cross(tangent);
  return plane.transpose() * covariance_mm2 * plane;
}

}  // namespace biteline::uncertainty
