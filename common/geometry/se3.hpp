// SPDX-License-Identifier: MIT
#pragma once
/// \file Rigid motions.  Names: `T_a_b` maps coordinates in b into a (FRAMES.md).  Lengths mm, angles rad.

#include <Eigen/Geometry>

namespace biteline {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// A rigid motion.  Pre everywhere: the linear part is a rotation.
using SE3 = Eigen::Isometry3d;
/// [rho; theta], mm and rad; perturbations act on the right: X * exp(xi).
using Twist = Eigen::Matrix<double, 6, 1>;

namespace geometry {

/// The matrix with hat(a) * b == a x b.
[[nodiscard]] Mat3 hat(const Vec3& a);

/// Rotation by |theta| about theta (Rodrigues), and its inverse with |theta| <= pi.
[[nodiscard]] Mat3 exp_so3(const Vec3& theta);
[[nodiscard]] Vec3 log_so3(const Mat3& R);

/// Exponential of SE(3) and its inverse; Sola, Deray, Atchuthan 2018 "A micro Lie theory", eq. (172) to
/// (174).
[[nodiscard]] SE3 exp_se3(const Twist& xi);
[[nodiscard]] Twist log_se3(const SE3& T);

/// The motion a fraction of the way from `T_from` to `T_to` along the geodesic T_from * exp(fraction *
/// log(T_from^-1 T_to)). Fractions outside [0, 1] extrapolate.
[[nodiscard]] SE3 interpolate(const SE3& T_from, const SE3& T_to, double fraction);

/// Rotation part made exactly orthonormal again (by its quaternion).
[[nodiscard]] SE3 orthonormalised(const SE3& T);

[[nodiscard]] SE3 make_se3(const Eigen::Quaterniond& rotation, const Vec3& translation_mm);

/// Angle of the rotation between two orientations, rad in [0, pi].
[[nodiscard]] double angle_between_rad(const Mat3& R_a, const Mat3& R_b);

}  // namespace geometry
}  // namespace biteline
