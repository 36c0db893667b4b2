// SPDX-License-Identifier: MIT
#include "tests/bench/robot/peers.hpp"

#include <kdl/chain.hpp>
#include <kdl/chainiksolverpos_lma.hpp>

namespace biteline::bench::peers {
namespace {

constexpr double k_mm_per_m = 1000;

KDL::Frame to_kdl(const SE3& T) {
  const Mat3 R = T.linear();
  const Vec3 p = T.translation() / k_mm_per_m;
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
          KDL::Vector(p.x(), p.y(), p.z())};
}

/// KDL turns first and then goes to the next frame; ours goes first: one fixed segment in front.
KDL::Chain chain_of(const kinematics::ArmModel& arm) {
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), to_kdl(arm.T_fixed[0])));
  for (std::size_t i = 0; i < kinematics::k_joints; ++i) {
    const KDL::Frame next =
        i + 1 < kinematics::k_joints ? to_kdl(arm.T_fixed[i + 1]) : KDL::Frame::Identity();
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), next));
  }
  return chain;
}

}  // namespace

struct KdlInverse::Solver {
  explicit Solver(const kinematics::ArmModel& arm) : chain{chain_of(arm)}, lma{chain, 1e-9, 500} {}
  KDL::Chain chain;
  KDL::ChainIkSolverPos_LMA lma;
};

bool has_kdl() {
  return true;
}
KdlInverse::KdlInverse(const kinematics::ArmModel& arm) : solver_{std::make_unique<Solver>(arm)} {}
KdlInverse::~KdlInverse() = default;

std::optional<kinematics::Joints> KdlInverse::solve(const SE3& T_base_flange,
                                                    const kinematics::Joints& guess_rad) {
  KDL::JntArray guess(6), found(6);
  for (unsigned i = 0; i < 6; ++i) guess(i) = guess_rad[i];
  if (solver_->lma.CartToJnt(guess, to_kdl(T_base_flange), found) < 0) return std::nullopt;
  kinematics::Joints q_rad;
  for (unsigned i = 0; i < 6; ++i) q_rad[i] = found(i);
  return q_rad;
}

}  // namespace biteline::bench::peers
