// SPDX-License-Identifier: MIT
#include "tests/bench/robot/peers.hpp"

namespace biteline::bench::peers {

struct KdlInverse::Solver {};
bool has_kdl() {
  return false;
}
KdlInverse::KdlInverse(const kinematics::ArmModel&) {}
KdlInverse::~KdlInverse() = default;
std::optional<kinematics::Joints> KdlInverse::solve(const SE3&, const kinematics::Joints&) {
  return std::nullopt;
}

}  // namespace biteline::bench::peers
