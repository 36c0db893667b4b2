// SPDX-License-Identifier: MIT
#include "host/geometry/symmetric.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::geometry {

namespace {

/// Eigenvalues 1, 2 and -3 about axes that lie along no coordinate.
Eigen::Matrix3d indefinite() {
  const Eigen::Vector3d u = Eigen::Vector3d{1, 2, 2} / 3, v = Eigen::Vector3d{2, 1, -2} / 3,
                        w = Eigen::Vector3d{2, -2, 1} / 3;
  return u * u.transpose() + 2 * v * v.transpose() - 3 * w * w.transpose();
}

}  // namespace

TEST_GROUP(Symmetric){};

TEST(Symmetric, EquationsOfAnIndefiniteMatrixAreSolvedForEachRightSide) {
  Eigen::Matrix<double, 3, 2> x;
  x << 1, -4, 2, 0.5, -7, 3;
  const Eigen::Matrix<double, 3, 2> found = solve_symmetric(indefinite(), indefinite() * x);
  DOUBLES_EQUAL(0, (found - x).norm(), 1e-12);
}

TEST(Symmetric, InverseTimesMatrixIsIdentity) {
  const SymmetricSolver sut{indefinite()};
  CHECK(sut.sound());
  DOUBLES_EQUAL(0, (sut.inverse() * indefinite() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(Symmetric, ADirectionThatNothingMeasuredIsLeftOut) {
  const Eigen::Vector3d seen{3, 4, 0};
  const Eigen::Vector3d found = solve_symmetric(seen * seen.transpose(), 25 * seen);
  CHECK(found.allFinite());
  DOUBLES_EQUAL(25, seen.dot(found), 1e-9);
}

TEST(Symmetric, AxesComeWithTheLeastValueFirst) {
  const auto [values, vectors] = principal_axes(indefinite());
  DOUBLES_EQUAL(-3, values[0], 1e-12);
  DOUBLES_EQUAL(1, values[1], 1e-12);
  DOUBLES_EQUAL(2, values[2], 1e-12);
  DOUBLES_EQUAL(1, std::abs(vectors.col(0).dot(Eigen::Vector3d{2, -2, 1} / 3)), 1e-12);
}

}  // namespace biteline::geometry
