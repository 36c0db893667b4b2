// SPDX-License-Identifier: MIT
#include "host/bite_line/evaluation/cloud_error.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numeric>

#include "host/bite_line/evaluation/statistics.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::evaluation {
namespace {

CloudError error_at(const cloud::PointCloud& cloud, const ReferenceSurface& surface,
                    const SE3& T_surface_cloud) {
  std::vector<double> signed_mm(cloud.size());
  std::vector<char> near(cloud.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, cloud.size(), 1024}, [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const auto found =
          surface.nearest(T_surface_cloud * cloud.points[i].cast<double>(), k_surface_reach_mm);
      if (!found) continue;
      near[i] = 1;
      signed_mm[i] = found->signed_distance_mm;
    }
  });
  std::vector<double> sorted;
  sorted.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (near[i] != 0) sorted.push_back(signed_mm[i]);
  }
  CloudError error;
  error.T_surface_cloud = T_surface_cloud;
  error.points = sorted.size();
  error.points_far = cloud.size() - sorted.size();
  if (sorted.empty()) return error;
  std::sort(sorted.begin(), sorted.end());
  double sum = 0, squares = 0, positive = 0, negative = 0;
  std::size_t positives = 0, negatives = 0;
  for (const double d_mm : sorted) {
    sum += d_mm;
    squares += d_mm * d_mm;
    if (d_mm > 0) positive += d_mm, ++positives;
    if (d_mm < 0) negative += d_mm, ++negatives;
  }
  const auto count = static_cast<double>(sorted.size());
  error.mean_mm = sum / count;
  error.rms_mm = std::sqrt(squares / count);
  error.mean_positive_mm = positives > 0 ? positive / static_cast<double>(positives) : 0;
  error.mean_negative_mm = negatives > 0 ? negative / static_cast<double>(negatives) : 0;
  error.q001_mm = quantile(sorted, 0.001);
  error.q999_mm = quantile(sorted, 0.999);
  error.min_mm = sorted.front();
  error.max_mm = sorted.back();
  return error;
}

}  // namespace

CloudError cloud_error(const cloud::PointCloud& cloud, const ReferenceSurface& surface) {
  return error_at(cloud, surface, SE3::Identity());
}

CloudError cloud_error_aligned(const cloud::PointCloud& cloud, const ReferenceSurface& surface) {
  constexpr std::size_t k_most_points = 50'000;
  constexpr int k_most_rounds = 60;
  constexpr double k_done = 1e-7;  // mm and rad: far below what is measured
  const std::size_t step = cloud.size() / k_most_points + 1;
  Vec3 middle = Vec3::Zero();
  for (const auto& p : cloud.points) middle += p.cast<double>();
  middle /= static_cast<double>(std::max<std::size_t>(cloud.size(), 1));

  SE3 T_surface_cloud = SE3::Identity();
  for (int round = 0; round < k_most_rounds; ++round) {
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    Twist b = Twist::Zero();
    std::vector<ReferenceSurface::Nearest> found(cloud.size() / step + 1);
    std::vector<Vec3> moved(found.size());
    std::vector<char> near(found.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>{0, (cloud.size() + step - 1) / step, 256},
                      [&](const auto& range) {
                        for (std::size_t k = range.begin(); k < range.end(); ++k) {
                          moved[k] = T_surface_cloud * cloud.points[k * step].cast<double>();
                          if (const auto nearest = surface.nearest(moved[k], k_surface_reach_mm)) {
                            found[k] = *nearest;
                            near[k] = 1;
                          }
                        }
                      });
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (near[k] == 0) continue;
      // d(theta, t) of n . (p - q) for a small motion about the cloud's middle.
      Twist row;
      row.head<3>() = found[k].normal;
      row.tail<3>() = (moved[k] - middle).cross(found[k].normal);
      A += row * row.transpose();
      b -= row * found[k].normal.dot(moved[k] - found[k].point);
    }
    const Twist step_xi = geometry::solve_symmetric(A + 1e-9 * Eigen::Matrix<double, 6, 6>::Identity(), b);
    SE3 T_step = SE3::Identity();
    T_step.linear() = geometry::exp_so3(step_xi.tail<3>());
    T_step.translation() = middle + step_xi.head<3>() - T_step.linear() * middle;
    T_surface_cloud = geometry::orthonormalised(T_step * T_surface_cloud);
    if (step_xi.norm() < k_done) break;
  }
  return error_at(cloud, surface, T_surface_cloud);
}

}  // namespace biteline::evaluation
