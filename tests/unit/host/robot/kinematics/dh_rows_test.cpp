// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/dh_rows.hpp"

#include <CppUTest/TestHarness.h>

#include <numbers>

#include "tests/support/errors.hpp"
#include "tests/support/transforms.hpp"
#include "tests/unit/host/robot/kinematics/arms.hpp"

namespace biteline::kinematics {
namespace {

using Rows = std::array<DhRow, k_joints>;

Rows nominal_rows(const ArmModel& arm) {
  constexpr double quarter = std::numbers::pi / 2;
  const DhLengths& n = arm.nominal;
  return {{{.d_mm = n.d1_mm, .alpha_rad = quarter},
           {.a_mm = n.a2_mm},
           {.a_mm = n.a3_mm},
           {.d_mm = n.d4_mm, .alpha_rad = quarter},
           {.d_mm = n.d5_mm, .alpha_rad = -quarter},
           {.d_mm = n.d6_mm}}};
}

/// The product as the makers write it: the oracle.
SE3 product(const Rows& rows, const Joints& q_rad) {
  SE3 T = SE3::Identity();
  for (std::size_t k = 0; k < k_joints; ++k) {
    T = T * Eigen::AngleAxisd(q_rad[static_cast<int>(k)] + rows[k].theta_rad, Vec3::UnitZ()) *
        Eigen::Translation3d(rows[k].a_mm, 0, rows[k].d_mm) *
        Eigen::AngleAxisd(rows[k].alpha_rad, Vec3::UnitX());
  }
  return T;
}

void same_arm(const Rows& rows, const ArmModel& arm, double tolerance_mm) {
  test::RandomJoints random{17};
  for (int i = 0; i < 100; ++i) {
    const Joints q_rad = random.next();
    TRANSFORMS_EQUAL(product(rows, q_rad), forward(arm, q_rad), tolerance_mm, 1e-9);
  }
}

}  // namespace

TEST_GROUP(DhRows){};

TEST(DhRows, NominalOnesAreTheNominalArm) {
  for (const std::string& name : arm_names()) {
    const ArmModel nominal = test::arm(name.c_str());
    const auto sut = with_rows(nominal, nominal_rows(nominal), "rows");
    SUCCEEDS(sut);
    for (std::size_t i = 0; i < k_joints; ++i)
      TRANSFORMS_EQUAL(nominal.T_fixed[i], sut->T_fixed[i], 1e-9, 1e-9);
    CHECK(sut->calibrated);
  }
}

TEST(DhRows, ArmsOwnAreItsForwardKinematics) {
  const ArmModel nominal = test::arm("UR10e");
  Rows rows = nominal_rows(nominal);
  for (std::size_t i = 0; i < k_joints; ++i) {
    const double sign = i % 2 == 0 ? 1 : -1;
    rows[i].theta_rad += sign * 0.0011 * static_cast<double>(i + 1) / 6;
    rows[i].d_mm += sign * 0.7;
    if (i + 1 < k_joints) rows[i].a_mm -= 0.4;
    if (i + 1 < k_joints) rows[i].alpha_rad -= sign * 0.0009;
  }
  const auto sut = with_rows(nominal, rows, "rows");
  SUCCEEDS(sut);
  same_arm(rows, *sut, 1e-9);
}

/// Axes 2, 3 and 4 a tenth of a milliradian apart: their common normals lie far away.
TEST(DhRows, CommonNormalsThatLieFarAwayAreBroughtBack) {
  const ArmModel nominal = test::arm("UR5e");
  Rows rows = nominal_rows(nominal);
  rows[1].alpha_rad = 1e-4;
  rows[2].alpha_rad = -1.3e-4;
  rows[1].d_mm = 3'000;
  rows[2].d_mm = -7'000;
  rows[3].d_mm += 4'000.3;
  const auto sut = with_rows(nominal, rows, "rows");
  SUCCEEDS(sut);
  same_arm(rows, *sut, 1e-7);  // 7 m of double: 1e-12 of it, times six joints
  for (std::size_t i = 0; i < k_joints; ++i)
    CHECK((sut->T_fixed[i].translation() - nominal.T_fixed[i].translation()).norm() < 1);
}

TEST(DhRows, RowsOfAnotherArmAreRefused) {
  const ArmModel ur5e = test::arm("UR5e"), ur10e = test::arm("UR10e");
  FAILS_NAMING(Errc::BadValue, "the calibration of another arm?",
               with_rows(ur5e, nominal_rows(ur10e), "the controller's kinematics"));
  Rows rows = nominal_rows(ur5e);
  rows[5].alpha_rad = 0.01;
  FAILS_NAMING(Errc::BadValue, "its last row", with_rows(ur5e, rows, "the controller's kinematics"));
}

}  // namespace biteline::kinematics
