// SPDX-License-Identifier: MIT
#include "host/calibration/handeye/motions.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

struct Motion {
  SE3 A;  ///< T_flange_j_flange_i
  SE3 B;  ///< T_cam_j_cam_i
};

std::vector<Motion> motions_of(std::span<const Stop> stops) {
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    for (std::size_t j = i + 1; j < stops.size(); ++j) {
      motions.push_back({.A = stops[j].T_base_flange.inverse() * stops[i].T_base_flange,
                         .B = stops[j].T_cam_target * stops[i].T_cam_target.inverse()});
    }
  }
  return motions;
}

/// Half turns have an axis of either sign: useless for matching axes.
constexpr double k_largest_half_axis = 0.996;  // sin(85 degrees)

}  // namespace

Vec3 half_axis(const Mat3& R) {
  const Eigen::Quaterniond q(R);
  return q.w() < 0 ? Vec3(-q.vec()) : Vec3(q.vec());
}

std::optional<Mat3> rotation_of_x(std::span<const Stop> stops) {
  Mat3 M = Mat3::Zero();
  for (const Motion& motion : motions_of(stops)) {
    const Vec3 a = half_axis(motion.A.linear()), b = half_axis(motion.B.linear());
    if (a.norm() > k_largest_half_axis || b.norm() > k_largest_half_axis) continue;
    M += a * b.transpose();
  }
  const Eigen::JacobiSVD<Mat3> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  // Two different axes fix a rotation; the third direction follows from its being one.
  if (!(svd.singularValues()[1] > 1e-6 * svd.singularValues()[0])) return std::nullopt;
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() > 0 ? 1 : -1;
  return Mat3(svd.matrixU() * Vec3(1, 1, sign).asDiagonal() * svd.matrixV().transpose());
}

std::optional<TranslationFit> translation_of_x(std::span<const Stop> stops, const Mat3& R_flange_cam) {
  const std::vector<Motion> motions = motions_of(stops);
  // The scale's column is brought to the size of the others: metres would make it vanish.
  double length = 0;
  for (const Motion& m : motions) length = std::max(length, m.A.translation().norm());
  if (!(length > 0)) return std::nullopt;
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double square_sum = 0;
  for (const Motion& m : motions) {
    Eigen::Matrix<double, 3, 4> J;
    J << m.A.linear() - Mat3::Identity(), m.A.translation() / length;
    const Vec3 y = R_flange_cam * m.B.translation();
    normal += J.transpose() * J;
    right += J.transpose() * y;
    square_sum += y.squaredNorm();
  }
  const geometry::SymmetricSolver solver{normal};
  const Eigen::Vector4d solution = solver.solve(right);
  if (!solver.sound() || !solution.allFinite()) return std::nullopt;
  const double rest = std::max(0.0, square_sum - solution.dot(right));
  const double freedom = std::max<double>(1, 3.0 * static_cast<double>(stops.size() - 1) - 4);
  // Pairs share stops: of n (n - 1) / 2 only n - 1 are independent.
  const double variance =
      rest / static_cast<double>(motions.size()) * static_cast<double>(stops.size() - 1) / freedom;
  const double share = static_cast<double>(motions.size()) / static_cast<double>(stops.size() - 1);
  TranslationFit fit;
  fit.translation_mm = solution.head<3>();
  fit.pose_scale = solution[3] / length;
  fit.pose_scale_sigma = std::sqrt(std::max(0.0, solver.inverse()(3, 3)) * share * variance) / length;
  fit.rms_mm = std::sqrt(rest / (3.0 * static_cast<double>(motions.size())));
  return fit;
}

TurningSpread turning_spread(std::span<const SE3> T_base_flanges) {
  TurningSpread spread;
  Mat3 scatter = Mat3::Zero();
  for (std::size_t i = 0; i < T_base_flanges.size(); ++i) {
    for (std::size_t j = i + 1; j < T_base_flanges.size(); ++j) {
      const Mat3 R = T_base_flanges[j].linear().transpose() * T_base_flanges[i].linear();
      const Vec3 a = half_axis(R);
      scatter += a * a.transpose();
      spread.largest_turn_rad = std::max(spread.largest_turn_rad, 2 * std::asin(std::min(1.0, a.norm())));
    }
  }
  const Vec3 values = Eigen::SelfAdjointEigenSolver<Mat3>(scatter).eigenvalues();
  if (values[2] > 0) spread.axes_spread_rad = std::atan(std::sqrt(std::max(0.0, values[1]) / values[2]));
  return spread;
}

}  // namespace biteline::calibration
