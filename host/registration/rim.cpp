// SPDX-License-Identifier: MIT
#include "host/registration/rim.hpp"

#include <algorithm>

namespace biteline::registration {
namespace {

constexpr std::size_t k_run_columns = 8;      // a shorter run at the end is speckle
constexpr float k_max_spacing_ratio = 4.0F;   // neighbours farther apart than this many usual distances: a hole between
constexpr std::size_t k_min_points = 30;

/// The profile [begin, end) seen from its upper end: where the surface goes on without a step, and how.
struct ProfileEnd {
  bool found{false};
  Eigen::Vector3f position{Eigen::Vector3f::Zero()};
  Eigen::Vector3f inward{Eigen::Vector3f::Zero()};  ///< along the profile, into the surface
};

ProfileEnd upper_end(const cloud::PointCloud& cloud, std::size_t begin, std::size_t end) {
  if (end - begin < 2 * k_run_columns) return {};
  const bool last_is_upper = cloud.points[end - 1].z() > cloud.points[begin].z();
  const auto at = [&](std::size_t steps) { return last_is_upper ? end - 1 - steps : begin + steps; };
  // Drop what is cut off from the rest by a missing column: the end of the last run that is long enough.
  std::size_t first = 0, run = 1;
  for (std::size_t k = 1; k < end - begin && run < k_run_columns; ++k) {
    const int columns = std::abs(int{cloud.column[at(k)]} - int{cloud.column[at(k - 1)]});
    if (columns == 1) {
      ++run;
    } else {
      first = k;
      run = 1;
    }
  }
  if (run < k_run_columns) return {};
  const Eigen::Vector3f& position = cloud.points[at(first)];
  return {.found = true, .position = position, .inward = (cloud.points[at(first + k_run_columns - 1)] - position).normalized()};
}

float median_spacing(const std::vector<Eigen::Vector3f>& positions) {
  std::vector<float> spacing;
  for (std::size_t i = 1; i < positions.size(); ++i) spacing.push_back((positions[i] - positions[i - 1]).norm());
  const auto middle = spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2);
  std::nth_element(spacing.begin(), middle, spacing.end());
  return *middle;
}

}  // namespace

Rim rim_of(const cloud::PointCloud& cloud) {
  Rim rim;
  if (!cloud.organised()) return rim;
  std::vector<Eigen::Vector3f> positions, inward;
  for (std::size_t begin = 0, end = 0; begin < cloud.size(); begin = end) {
    while (end < cloud.size() && cloud.profile[end] == cloud.profile[begin]) ++end;
    const ProfileEnd edge = upper_end(cloud, begin, end);
    if (!edge.found) continue;
    positions.push_back(edge.position);
    inward.push_back(edge.inward);
  }
  if (positions.size() < k_min_points) return rim;
  rim.spacing_mm = median_spacing(positions);
  for (std::size_t i = 1; i + 1 < positions.size(); ++i) {
    const Eigen::Vector3f before = positions[i] - positions[i - 1], after = positions[i + 1] - positions[i];
    const float limit_mm = k_max_spacing_ratio * rim.spacing_mm;
    if (before.norm() > limit_mm || after.norm() > limit_mm) continue;
    const Eigen::Vector3f along = (before + after).normalized();
    rim.positions.push_back(positions[i]);
    rim.across.push_back((inward[i] - inward[i].dot(along) * along).normalized());
  }
  return rim;
}

std::uint32_t nearest_on(const Rim& rim, const Eigen::Vector3f& point) {
  std::uint32_t best = 0;
  float best_squared = (rim.positions[0] - point).squaredNorm();
  for (std::uint32_t i = 1; i < rim.size(); ++i) {
    const float squared = (rim.positions[i] - point).squaredNorm();
    if (squared < best_squared) {
      best = i;
      best_squared = squared;
    }
  }
  return best;
}

}  // namespace biteline::registration
