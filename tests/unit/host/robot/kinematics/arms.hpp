// SPDX-License-Identifier: MIT
#pragma once
/// \file Arms and seeded joint sets for the tests of this folder.

#include <random>

#include "host/robot/kinematics/chain.hpp"

namespace biteline::kinematics::test {

inline ArmModel arm(const char* name) {
  return *arm_model(name);
}

/// An arm that differs from its nominal model as calibrated arms do: 1 mm and 3 mrad per joint.
inline ArmModel calibrated_arm(const char* name, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  ArmModel out = arm(name);
  for (SE3& T : out.T_fixed) {
    Twist xi;
    for (int i = 0; i < 6; ++i) xi[i] = normal(random) * (i < 3 ? 1.0 : 0.003);
    T = T * geometry::exp_se3(xi);
  }
  out.calibrated = true;
  return out;
}

class RandomJoints {
 public:
  explicit RandomJoints(std::uint64_t seed) : random_{seed} {}
  Joints next() {
    Joints q_rad;
    for (double& angle_rad : q_rad) angle_rad = angle_(random_);
    return q_rad;
  }

 private:
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> angle_{-3.14159, 3.14159};
};

}  // namespace biteline::kinematics::test
