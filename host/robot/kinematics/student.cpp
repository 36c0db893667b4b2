// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/student.hpp"

#include <array>
#include <cstddef>

namespace biteline::kinematics {

double student_95(int freedom) {
  // Any table of t(0.975).
  constexpr std::array k_few{12.706, 4.303, 3.182, 2.776, 2.571, 2.447};
  if (freedom <= static_cast<int>(k_few.size())) return k_few.at(static_cast<std::size_t>(freedom) - 1);
  // Cornish and Fisher's expansion, its first three terms.
  constexpr double k_z = 1.959964, k_z3 = k_z * k_z * k_z, k_z5 = k_z3 * k_z * k_z, k_z7 = k_z5 * k_z * k_z;
  const double n = freedom;
  return k_z + (k_z3 + k_z) / (4 * n) + (5 * k_z5 + 16 * k_z3 + 3 * k_z) / (96 * n * n) +
         (3 * k_z7 + 19 * k_z5 + 17 * k_z3 - 15 * k_z) / (384 * n * n * n);
}

}  // namespace biteline::kinematics
