// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/calibration.hpp"

#include <CppUTest/TestHarness.h>

#include "host/robot/kinematics/inverse.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/transforms.hpp"
#include "tests/unit/host/robot/kinematics/arms.hpp"

namespace biteline::kinematics {

TEST_GROUP(Calibration){};

TEST(Calibration, NominalFilesGiveTheNominalArm) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "robot/ur_description");
  for (const char* name : {"ur3e", "ur5e", "ur10e", "ur5"}) {
    const ArmModel arm = test::arm(name);
    const auto read = with_calibration(arm, folder / name / "default_kinematics.yaml");
    CHECK_TEXT(read.has_value(), name);
    test::RandomJoints random{31};
    for (int i = 0; i < 20; ++i) {
      const Joints q_rad = random.next();
      // The files round pi / 2 to nine digits: 2e-10 rad over a metre.
      TRANSFORMS_EQUAL(forward(arm, q_rad), forward(*read, q_rad), 1e-6, 1e-8);
    }
  }
}

TEST(Calibration, FactoryFilesMoveTheFlangeByMillimetresAndInvert) {
  struct Row {
    const char* arm;
    const char* file;
  };
  BITELINE_SHARED_DATA_OR_SKIP(folder, "robot/ur_factory_calibrations");
  for (const Row& row :
       {Row{"UR5e", "ur5e_pablotrelis_haptic.yaml"}, Row{"UR10e", "ur10e_sibeschu_Scorpion.yaml"}}) {
    const ArmModel nominal = test::arm(row.arm);
    const auto read = with_calibration(nominal, folder / row.file);
    CHECK_TEXT(read.has_value(), row.file);
    Joints q_rad;
    q_rad << 0.3, -1.2, 1.1, -0.7, 0.9, 0.2;
    const SE3 T = forward(*read, q_rad);
    const double shift_mm = (T.translation() - forward(nominal, q_rad).translation()).norm();
    CHECK_TEXT(shift_mm > 0.1 && shift_mm < 15, row.file);
    const Solutions solutions = inverse(*read, T);
    CHECK_EQUAL(8U, solutions.size());
    for (const Solution& solution : solutions)
      TRANSFORMS_EQUAL(T, forward(*read, solution.q_rad), 1e-6, 1e-8);
  }
}

TEST(Calibration, AnotherArmsFileIsRefused) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "robot/ur_factory_calibrations");
  const auto read = with_calibration(test::arm("UR5e"), folder / "ur10e_sibeschu_Scorpion.yaml");
  CHECK_FALSE(read.has_value());
  CHECK(read.error().code == Errc::BadValue);
}

}  // namespace biteline::kinematics
