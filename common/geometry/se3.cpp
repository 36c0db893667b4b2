// SPDX-License-Identifier: MIT
#include "common/geometry/se3.hpp"

#include <cmath>

namespace biteline::geometry {
namespace {

// Below this angle the closed forms lose digits and the series to second order is exact to double precision.
constexpr double k_small_angle_rad = 1e-5;

/// V of A micro Lie theory, eq. (174): translation of exp(xi) is V(theta) rho.
Mat3 left_jacobian_so3(const Vec3& theta) {
  const double angle_rad = theta.norm();
  const Mat3 W = hat(theta);
  if (angle_rad < k_small_angle_rad) return Mat3::Identity() + 0.5 * W + W * W / 6.0;
  const double a2 = angle_rad * angle_rad;
  return Mat3::Identity() + (1.0 - std::cos(angle_rad)) / a2 * W +
         (angle_rad - std::sin(angle_rad)) / (a2 * angle_rad) * W * W;
}

}  // namespace

Mat3 hat(const Vec3& a) {
  Mat3 A;
  A << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return A;
}

Mat3 exp_so3(const Vec3& theta) {
  const double angle_rad = theta.norm();
  if (angle_rad < k_small_angle_rad) {
    const Mat3 W = hat(theta);
    return Mat3::Identity() + W + 0.5 * W * W;
  }
  return Eigen::AngleAxisd(angle_rad, theta / angle_rad).toRotationMatrix();
}

Vec3 log_so3(const Mat3& R) {
  // By the quaternion: stable at 0 and at pi, where the formula by trace and skew part is not.
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine_half = q.vec().norm();
  if (sine_half < 0.5 * k_small_angle_rad) return 2.0 * q.vec();
  return 2.0 * std::atan2(sine_half, q.w()) / sine_half * q.vec();
}

SE3 exp_se3(const Twist& xi) {
  SE3 T = SE3::Identity();
  T.linear() = exp_so3(xi.tail<3>());
  T.translation() = left_jacobian_so3(xi.tail<3>()) * xi.head<3>();
  return T;
}

Twist log_se3(const SE3& T) {
  Twist xi;
  xi.tail<3>() = log_so3(T.linear());
  xi.head<3>() = left_jacobian_so3(xi.tail<3>()).inverse() * T.translation();
  return xi;
}

SE3 interpolate(const SE3& T_from, const SE3& T_to, double fraction) {
  return T_from * exp_se3(fraction * log_se3(T_from.inverse() * T_to));
}

SE3 orthonormalised(const SE3& T) {
  SE3 out = T;
  out.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return out;
}

SE3 make_se3(const Eigen::Quaterniond& rotation, const Vec3& translation_mm) {
  SE3 T = SE3::Identity();
  T.linear() = rotation.normalized().toRotationMatrix();
  T.translation() = translation_mm;
  return T;
}

double angle_between_rad(const Mat3& R_a, const Mat3& R_b) {
  return log_so3(R_a.transpose() * R_b).norm();
}

}  // namespace biteline::geometry
