// SPDX-License-Identifier: MIT
#include "host/transfer/align/shoe_axes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/contracts.hpp"

namespace biteline::transfer {
namespace {

constexpr int k_slices = 20;

/// Extent of the plan across, in slices along its length.
struct Plan {
  struct Slice {
    double left_mm{0}, right_mm{0};
    bool empty{true};
  };
  std::array<Slice, k_slices> slices;

  [[nodiscard]] double width_mm(int i) const {
    return slices[static_cast<std::size_t>(i)].left_mm - slices[static_cast<std::size_t>(i)].right_mm;
  }
  [[nodiscard]] double middle_mm(int i) const {
    return (slices[static_cast<std::size_t>(i)].left_mm + slices[static_cast<std::size_t>(i)].right_mm) / 2;
  }

  [[nodiscard]] double centroid_ratio() const {
    double area = 0, moment = 0;
    for (int i = 0; i < k_slices; ++i) {
      area += width_mm(i);
      moment += width_mm(i) * (i + 0.5) / k_slices;
    }
    return area > 0 ? moment / area : 0.5;
  }

  [[nodiscard]] double mean_middle_mm(int from, int to) const {
    double sum = 0;
    for (int i = from; i < to; ++i) sum += middle_mm(i);
    return sum / (to - from);
  }
};

Plan plan_of(const Surfels& surfels, const Vec3& origin, const Vec3& x, const Vec3& y, double length_mm) {
  Plan plan;
  for (const Eigen::Vector3f& position : surfels.positions) {
    const Vec3 d = position.cast<double>() - origin;
    const int i = std::clamp(static_cast<int>(d.dot(x) / length_mm * k_slices), 0, k_slices - 1);
    Plan::Slice& slice = plan.slices[static_cast<std::size_t>(i)];
    const double across_mm = d.dot(y);
    slice.left_mm = slice.empty ? across_mm : std::max(slice.left_mm, across_mm);
    slice.right_mm = slice.empty ? across_mm : std::min(slice.right_mm, across_mm);
    slice.empty = false;
  }
  return plan;
}

struct Range {
  double low{0}, high{0};
};

/// From the 0.2 % to the 99.8 % quantile: a few stray surfels move nothing.
template <class Coordinate>
Range range_of(const Surfels& surfels, Coordinate coordinate) {
  std::vector<double> values;
  values.reserve(surfels.size());
  for (const Eigen::Vector3f& position : surfels.positions)
    values.push_back(coordinate(position.cast<double>()));
  const std::size_t stray = values.size() / 500;
  const auto low = values.begin() + static_cast<std::ptrdiff_t>(stray);
  std::nth_element(values.begin(), low, values.end());
  const double lowest = *low;
  const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(stray);
  std::nth_element(values.begin(), high, values.end());
  return {lowest, *high};
}

Vec3 longest_horizontal_direction(const Surfels& surfels, Vec3& mean) {
  mean.setZero();
  for (const Eigen::Vector3f& position : surfels.positions) mean += position.cast<double>();
  mean /= static_cast<double>(surfels.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector3f& position : surfels.positions) {
    const Vec2 d = (position.cast<double>() - mean).head<2>();
    covariance += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(covariance / static_cast<double>(surfels.size()));
  return {solver.eigenvectors()(0, 1), solver.eigenvectors()(1, 1), 0};
}

}  // namespace

ShoeAxes shoe_axes(const Surfels& surfels) {
  BITELINE_EXPECTS(surfels.size() >= 3);
  Vec3 mean;
  Vec3 x = longest_horizontal_direction(surfels, mean);
  const Vec3 z = Vec3::UnitZ();
  Range along = range_of(surfels, [&](const Vec3& p) { return (p - mean).dot(x); });
  const double length_mm = std::max(along.high - along.low, 1e-3);
  Vec3 y = z.cross(x);
  Plan plan = plan_of(surfels, mean + along.low * x, x, y, length_mm);
  if (plan.centroid_ratio() < 0.5) {
    x = -x;
    y = -y;
    along = {-along.high, -along.low};
    plan = plan_of(surfels, mean + along.low * x, x, y, length_mm);
  }
  const Range across = range_of(surfels, [&](const Vec3& p) { return (p - mean).dot(y); });
  const Range up = range_of(surfels, [](const Vec3& p) { return p.z(); });

  ShoeAxes axes{.length_mm = length_mm, .width_mm = across.high - across.low};
  Vec3 origin = mean + along.low * x + plan.mean_middle_mm(0, 4) * y;
  origin.z() = up.low;
  axes.T_base_shoe.linear().col(0) = x;
  axes.T_base_shoe.linear().col(1) = y;
  axes.T_base_shoe.linear().col(2) = z;
  axes.T_base_shoe.translation() = origin;
  return axes;
}

}  // namespace biteline::transfer
