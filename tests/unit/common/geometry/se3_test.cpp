// SPDX-License-Identifier: MIT
#include "common/geometry/se3.hpp"

#include <CppUTest/TestHarness.h>

#include <numbers>
#include <random>

#include "tests/support/transforms.hpp"

namespace biteline::geometry {

TEST_GROUP(Se3) {
  std::mt19937_64 random{7};
  std::uniform_real_distribution<double> unit{-1.0, 1.0};

  Twist random_twist(double length_mm, double angle_rad) {
    Twist xi;
    for (int i = 0; i < 6; ++i) xi[i] = unit(random);
    xi.head<3>() *= length_mm;
    xi.tail<3>() = xi.tail<3>().normalized() * angle_rad;
    return xi;
  }
};

// 1e-9: double precision at 1000 mm is 1e-13, the half-angle at pi costs three digits more.
constexpr double k_tol = 1e-9;

TEST(Se3, LogInvertsExpFromZeroToNearlyPi) {
  for (const double angle_rad : {0.0, 1e-9, 1e-5, 1e-3, 0.5, 2.0, std::numbers::pi - 1e-6}) {
    for (int i = 0; i < 50; ++i) {
      const Twist xi = random_twist(1000, angle_rad);
      DOUBLES_EQUAL(0.0, (log_se3(exp_se3(xi)) - xi).norm(), 1e-6);
      TRANSFORMS_EQUAL(exp_se3(xi), exp_se3(log_se3(exp_se3(xi))), k_tol, k_tol);
    }
  }
}

TEST(Se3, ExpMatchesTheMatrixSeries) {
  const Twist xi = random_twist(3, 0.7);
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A.topLeftCorner<3, 3>() = hat(xi.tail<3>());
  A.topRightCorner<3, 1>() = xi.head<3>();
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity(), term = Eigen::Matrix4d::Identity();
  for (int k = 1; k < 30; ++k) sum += term = term * A / k;
  DOUBLES_EQUAL(0.0, (exp_se3(xi).matrix() - sum).norm(), k_tol);
}

TEST(Se3, InterpolationHitsItsEndsAndKeepsConstantTwist) {
  const SE3 T_from = exp_se3(random_twist(500, 1.0)), T_to = exp_se3(random_twist(500, 1.2));
  TRANSFORMS_EQUAL(T_from, interpolate(T_from, T_to, 0), k_tol, k_tol);
  TRANSFORMS_EQUAL(T_to, interpolate(T_from, T_to, 1), k_tol, k_tol);
  const SE3 T_half = interpolate(T_from, T_to, 0.5);
  TRANSFORMS_EQUAL(T_from.inverse() * T_half, T_half.inverse() * T_to, k_tol, k_tol);
}

TEST(Se3, InterpolationIsEquivariantOnTheLeft) {
  // Asymmetric: swapping base and flange in interpolate() would break it.
  const SE3 T = exp_se3(random_twist(100, 0.8)), T_from = exp_se3(random_twist(500, 1.0)),
            T_to = exp_se3(random_twist(500, 1.2));
  TRANSFORMS_EQUAL(T * interpolate(T_from, T_to, 0.3), interpolate(T * T_from, T * T_to, 0.3), k_tol, k_tol);
}

}  // namespace biteline::geometry
