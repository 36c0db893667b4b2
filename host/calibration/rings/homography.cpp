// SPDX-License-Identifier: MIT
#include "host/calibration/rings/homography.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

/// Maps points to zero mean and mean distance sqrt(2).
template <class Get>
Mat3 normaliser(std::span<const PlanePoint> points, Get get) {
  Vec2 mean = Vec2::Zero();
  for (const PlanePoint& point : points) mean += get(point);
  mean /= static_cast<double>(points.size());
  double distance = 0;
  for (const PlanePoint& point : points) distance += (get(point) - mean).norm();
  distance /= static_cast<double>(points.size());
  const double scale = distance > 0 ? std::sqrt(2.0) / distance : 1.0;
  Mat3 N = Mat3::Identity();
  N(0, 0) = N(1, 1) = scale;
  N.topRightCorner<2, 1>() = -scale * mean;
  return N;
}

void refine(Mat3& H, std::span<const PlanePoint> points) {
  for (int iteration = 0; iteration < 5; ++iteration) {
    Eigen::Matrix<double, 8, 8> information = Eigen::Matrix<double, 8, 8>::Zero();
    Eigen::Matrix<double, 8, 1> gradient = Eigen::Matrix<double, 8, 1>::Zero();
    for (const PlanePoint& point : points) {
      const Vec3 p = point.plane.homogeneous();
      const Vec3 q = H * p;
      if (std::abs(q[2]) < 1e-12) return;
      Eigen::Matrix<double, 2, 8> J = Eigen::Matrix<double, 2, 8>::Zero();
      J.block<1, 3>(0, 0) = p.transpose() / q[2];
      J.block<1, 3>(1, 3) = p.transpose() / q[2];
      J.block<1, 2>(0, 6) = -q[0] / (q[2] * q[2]) * point.plane.transpose();
      J.block<1, 2>(1, 6) = -q[1] / (q[2] * q[2]) * point.plane.transpose();
      information += J.transpose() * J;
      gradient += J.transpose() * (point.image - q.head<2>() / q[2]);
    }
    const Eigen::Matrix<double, 8, 1> step = geometry::solve_symmetric(information, gradient);
    if (!step.allFinite()) return;
    H.row(0) += step.segment<3>(0).transpose();
    H.row(1) += step.segment<3>(3).transpose();
    H.block<1, 2>(2, 0) += step.segment<2>(6).transpose();
    if (step.norm() < 1e-12) return;
  }
}

}  // namespace

std::optional<Mat3> fit_homography(std::span<const PlanePoint> points) {
  if (points.size() < 4) return std::nullopt;
  const Mat3 N_plane = normaliser(points, [](const PlanePoint& p) { return p.plane; });
  const Mat3 N_image = normaliser(points, [](const PlanePoint& p) { return p.image; });
  std::vector<PlanePoint> scaled;
  scaled.reserve(points.size());
  Eigen::Matrix<double, 9, 9> scatter = Eigen::Matrix<double, 9, 9>::Zero();
  for (const PlanePoint& point : points) {
    const Vec3 p = N_plane * point.plane.homogeneous();
    const Vec3 q = N_image * point.image.homogeneous();
    scaled.push_back({.plane = p.head<2>(), .image = q.head<2>()});
    Eigen::Matrix<double, 2, 9> rows = Eigen::Matrix<double, 2, 9>::Zero();
    rows.block<1, 3>(0, 0) = p.transpose();
    rows.block<1, 3>(0, 6) = -q[0] * p.transpose();
    rows.block<1, 3>(1, 3) = p.transpose();
    rows.block<1, 3>(1, 6) = -q[1] * p.transpose();
    scatter += rows.transpose() * rows;
  }
  const auto [values, vectors] = geometry::principal_axes(scatter);
  // A second vanishing eigenvalue: points on a line, or fewer than four different ones.
  if (values[1] < 1e-10 * values[8]) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = vectors.col(0);
  Mat3 H;
  H << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  if (std::abs(H(2, 2)) < 1e-9) return std::nullopt;
  H /= H(2, 2);
  refine(H, scaled);
  H = N_image.inverse() * H * N_plane;
  if (!H.allFinite() || std::abs(H(2, 2)) < 1e-12) return std::nullopt;
  return Mat3(H / H(2, 2));
}

Vec2 apply_homography(const Mat3& H, const Vec2& plane) {
  const Vec3 q = H * plane.homogeneous();
  return q.head<2>() / q[2];
}

double homography_orientation(const Mat3& H, const Vec2& plane) {
  // d(q / w): det of the Jacobian of a projective map is det(H) / w^3.
  const double w = (H * plane.homogeneous())[2];
  return H.determinant() / (w * w * w);
}

}  // namespace biteline::calibration
