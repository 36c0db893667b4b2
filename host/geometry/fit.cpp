// SPDX-License-Identifier: MIT
#include "host/geometry/fit.hpp"

#include <Eigen/Eigenvalues>

namespace biteline::geometry {

std::optional<PlaneFit> fit_plane(std::span<const Vec3> points) {
  if (points.size() < 3) return std::nullopt;
  const auto count = static_cast<double>(points.size());
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / count;
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& p : points) covariance += (p - mean) * (p - mean).transpose();
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(covariance / count);
  return PlaneFit{
      .mean = mean, .normal = solver.eigenvectors().col(0).normalized(), .spread_mm2 = solver.eigenvalues()};
}

std::optional<double> LineSums::slope() const {
  const double det = n_ * xx_ - x_ * x_;
  if (!(det > 1e-9)) return std::nullopt;
  return (n_ * xy_ - x_ * y_) / det;
}

}  // namespace biteline::geometry
