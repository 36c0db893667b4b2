// SPDX-License-Identifier: MIT
#pragma once
/// \file Rigid motions.  `T_a_b` maps coordinates in b into a.  Lengths in mm, angles in rad.

#include <Eigen/Geometry>

namespace biteline::sdk {

/// Not aligned: it has the same form whatever instructions a program is compiled for.
using Motion = Eigen::Transform<double, 3, Eigen::Isometry, Eigen::DontAlign>;

}  // namespace biteline::sdk
