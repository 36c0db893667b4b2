// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/chain.hpp"

#include <CppUTest/TestHarness.h>

#include <numbers>

#include "tests/support/transforms.hpp"
#include "tests/unit/host/robot/kinematics/arms.hpp"

namespace biteline::kinematics {

constexpr double k_tol = 1e-9;

TEST_GROUP(Chain){};

TEST(Chain, MatchesTheDenavitHartenbergProduct) {
  // Oracle: T = product of Rz(q) Tz(d) Tx(a) Rx(alpha), the makers' own convention.
  test::RandomJoints random{3};
  for (const std::string& name : arm_names()) {
    const ArmModel arm = test::arm(name.c_str());
    const DhLengths& n = arm.nominal;
    const double half = std::numbers::pi / 2;
    const std::array<std::array<double, 3>, 6> rows{{{n.d1_mm, 0, half},
                                                     {0, n.a2_mm, 0},
                                                     {0, n.a3_mm, 0},
                                                     {n.d4_mm, 0, half},
                                                     {n.d5_mm, 0, -half},
                                                     {n.d6_mm, 0, 0}}};
    for (int i = 0; i < 50; ++i) {
      const Joints q_rad = random.next();
      SE3 expected = SE3::Identity();
      for (std::size_t k = 0; k < 6; ++k) {
        expected = expected * Eigen::AngleAxisd(q_rad[static_cast<int>(k)], Vec3::UnitZ()) *
                   Eigen::Translation3d(rows[k][1], 0, rows[k][0]) *
                   Eigen::AngleAxisd(rows[k][2], Vec3::UnitX());
      }
      TRANSFORMS_EQUAL(expected, forward(arm, q_rad), k_tol, k_tol);
    }
  }
}

TEST(Chain, ZeroPoseOfTheUr5eIsItsDataSheets) {
  // Asymmetric: stretched along -x, tool plate towards -y; a swapped axis or sign shows.
  const SE3 T = forward(test::arm("ur5e"), Joints::Zero());
  DOUBLES_EQUAL(-817.2, T.translation().x(), k_tol);
  DOUBLES_EQUAL(-232.9, T.translation().y(), k_tol);
  DOUBLES_EQUAL(62.8, T.translation().z(), k_tol);
  DOUBLES_EQUAL(-1, T.linear()(1, 2), k_tol);
}

TEST(Chain, JacobianMatchesDifferences) {
  test::RandomJoints random{4};
  const ArmModel arm = test::calibrated_arm("UR10e", 9);
  const Vec3 tip_flange{20, -30, 150};
  constexpr double k_step_rad = 1e-6;
  for (int i = 0; i < 50; ++i) {
    const Joints q_rad = random.next();
    const SE3 T = forward(arm, q_rad);
    const Jacobian J = jacobian(arm, q_rad, T * tip_flange);
    for (int joint = 0; joint < 6; ++joint) {
      Joints q_plus = q_rad, q_minus = q_rad;
      q_plus[joint] += k_step_rad;
      q_minus[joint] -= k_step_rad;
      const SE3 T_plus = forward(arm, q_plus), T_minus = forward(arm, q_minus);
      const Vec3 speed = (T_plus * tip_flange - T_minus * tip_flange) / (2 * k_step_rad);
      const Vec3 turning =
          geometry::log_so3(T_plus.linear() * T_minus.linear().transpose()) / (2 * k_step_rad);
      DOUBLES_EQUAL(0.0, (J.col(joint).head<3>() - speed).norm(),
                    1e-5);  // 1000 mm * step^2 and rounding 1e-13/step
      DOUBLES_EQUAL(0.0, (J.col(joint).tail<3>() - turning).norm(), 1e-8);
    }
  }
}

TEST(Chain, SingularityMeasuresVanishWhereTheJacobianDoes) {
  const ArmModel arm = test::arm("UR5e");
  Joints q_rad;
  q_rad << 0.3, -1.2, 1.1, -0.7, 0.9, 0.2;
  CHECK(singularity(arm, q_rad).worst() > 0.1);
  Joints wrist = q_rad, elbow = q_rad;
  wrist[4] = 0;
  elbow[2] = 0;
  DOUBLES_EQUAL(0.0, singularity(arm, wrist).worst(), k_tol);
  DOUBLES_EQUAL(0.0, singularity(arm, elbow).worst(), k_tol);
  for (const Joints& singular : {wrist, elbow}) {
    Jacobian J = jacobian(arm, singular, forward(arm, singular).translation());
    J.topRows<3>() /= 1000;
    DOUBLES_EQUAL(0.0, J.determinant(), 1e-12);
  }
}

TEST(Chain, UnknownRobotIsToldWhichAreKnown) {
  const auto result = arm_model("KR6");
  CHECK_FALSE(result.has_value());
  CHECK(result.error().where.view().find("UR10e") != std::string_view::npos);
}

}  // namespace biteline::kinematics
