// SPDX-License-Identifier: MIT
// Kinematics and path planning: 100 000 random poses per arm, and whole plans.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include "host/robot/kinematics/inverse.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/plan.hpp"
#include "tests/bench/robot/peers.hpp"
#include "tests/unit/host/robot/kinematics/arms.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::bench {
namespace {

using kinematics::ArmModel;
using kinematics::Joints;
using Clock = std::chrono::steady_clock;

constexpr int k_poses = 100'000;
constexpr int k_peer_poses = 5'000;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

bool contains(const kinematics::Solutions& solutions, const Joints& q_rad) {
  for (const kinematics::Solution& solution : solutions) {
    double worst_rad = 0;
    for (int i = 0; i < 6; ++i)
      worst_rad =
          std::max(worst_rad, std::abs(kinematics::nearest_turn(solution.q_rad[i], q_rad[i]) - q_rad[i]));
    if (worst_rad < 1e-4) return true;
  }
  return false;
}

struct Outcome {
  double us{0};
  int missed{0};
  double worst_mm{0};
  double solutions{0};
};

/// Random joints, their pose, all solutions: the joints must be among them and every solution must meet the
/// pose.
Outcome invert(const ArmModel& arm, int poses) {
  kinematics::test::RandomJoints random{2024};
  Outcome out;
  double spent_s = 0;
  for (int i = 0; i < poses; ++i) {
    const Joints q_rad = random.next();
    const SE3 T = kinematics::forward(arm, q_rad);
    const auto begin = Clock::now();
    const kinematics::Solutions solutions = kinematics::inverse(arm, T);
    spent_s += seconds_since(begin);
    out.solutions += static_cast<double>(solutions.size()) / poses;
    if (!contains(solutions, q_rad)) ++out.missed;
    for (const kinematics::Solution& solution : solutions) {
      out.worst_mm = std::max(
          out.worst_mm, (kinematics::forward(arm, solution.q_rad).translation() - T.translation()).norm());
    }
  }
  out.us = spent_s * 1e6 / poses;
  return out;
}

struct PeerOutcome {
  double us{0};
  int failed{0};
};
PeerOutcome invert_by_kdl(const ArmModel& arm) {
  peers::KdlInverse kdl{arm};
  kinematics::test::RandomJoints random{2024};
  PeerOutcome out;
  double spent_s = 0;
  for (int i = 0; i < k_peer_poses; ++i) {
    const Joints q_rad = random.next();
    const SE3 T = kinematics::forward(arm, q_rad);
    Joints guess_rad = q_rad;
    guess_rad.array() += 0.3;  // kindly near one of the answers
    const auto begin = Clock::now();
    const auto found = kdl.solve(T, guess_rad);
    spent_s += seconds_since(begin);
    if (!found) ++out.failed;
  }
  out.us = spent_s * 1e6 / k_peer_poses;
  return out;
}

void row(const char* bench, const std::string& what, double ours, const char* unit, const std::string& peer,
         double peer_value, double target) {
  if (peer.empty()) {
    std::printf("{\"bench\":\"%s\",\"what\":\"%s\",\"ours\":%.6g,\"unit\":\"%s\",\"target\":%.6g}\n", bench,
                what.c_str(), ours, unit, target);
  } else {
    std::printf(
        "{\"bench\":\"%s\",\"what\":\"%s\",\"ours\":%.6g,\"peer\":\"%s\",\"peer_value\":%.6g,\"unit\":\"%s\","
        "\"ratio\":%.6g,\"target\":%.6g}\n",
        bench, what.c_str(), ours, peer.c_str(), peer_value, unit, ours / peer_value, target);
  }
  std::fflush(stdout);
}

void inverse_rows() {
  for (const std::string& name : kinematics::arm_names()) {
    const ArmModel arm = *kinematics::arm_model(name);
    const Outcome ours = invert(arm, k_poses);
    row("kinematics.ik_missed", name + ", all branches, of 100000 poses", ours.missed, "poses", "", 0, 0);
    row("kinematics.ik_worst", name + ", pose error of any solution", ours.worst_mm, "mm", "", 0, 1e-3);
    if (name != "UR5e") continue;
    if (peers::has_kdl()) {
      const PeerOutcome kdl = invert_by_kdl(arm);
      row("kinematics.ik", name + ", all branches against one from a near guess", ours.us, "us",
          "Orocos KDL LMA", kdl.us, kdl.us / 2);
      row("kinematics.ik_failed", name + ", share of poses", static_cast<double>(ours.missed) / k_poses, "1",
          "Orocos KDL LMA", std::max(1e-12, static_cast<double>(kdl.failed) / k_peer_poses), 0);
    } else {
      std::fprintf(stderr,
                   "  Orocos KDL is missing (liborocos-kdl-dev): no peer for the inverse kinematics\n");
      row("kinematics.ik", name + ", all branches", ours.us, "us", "", 0, 10);
    }
    constexpr int k_calibrated_poses = 5'000;
    const Outcome calibrated = invert(kinematics::test::calibrated_arm(name.c_str(), 77), k_calibrated_poses);
    row("kinematics.ik_calibrated_missed", name + ", 1 mm and 3 mrad per joint, share of poses",
        static_cast<double>(calibrated.missed) / k_calibrated_poses, "1", "", 0, 1e-3);
    row("kinematics.ik_calibrated", name + ", mean", calibrated.us, "us", "", 0, 2000);
  }
}

void plan_rows() {
  for (const char* process : {"grind", "spray"}) {
    const path::PlanRequest request{.line = path::test::made_line(),
                                    .process = *path::read_process(std::filesystem::path{BITELINE_PROCESSES} /
                                                                   (std::string{process} + ".yaml")),
                                    .arm = *kinematics::arm_model("UR5e"),
                                    .T_line_base = SE3::Identity(),
                                    .table_z_mm = 40,
                                    .shoe = {},
                                    .cloud = {}};
    double best_s = 1e9;
    for (int round = 0; round < 3; ++round) {
      const auto begin = Clock::now();
      const path::PlanOutcome outcome = path::plan(request);
      if (!outcome.path) {
        std::fprintf(stderr, "  plan refused: %s\n", outcome.reason().c_str());
        return;
      }
      static_cast<void>(robot::ur::urscript(*outcome.path));
      best_s = std::min(best_s, seconds_since(begin));
    }
    row("trajectory.plan", std::string{"UR5e "} + process + ", line to checked script", best_s, "s", "", 0,
        0.3);
  }
}

}  // namespace
}  // namespace biteline::bench

int main() {
  biteline::bench::inverse_rows();
  biteline::bench::plan_rows();
  return 0;
}
