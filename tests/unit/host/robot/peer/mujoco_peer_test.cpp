// SPDX-License-Identifier: MIT
// Masses, centres and inertias: Universal Robots' ROS description (BSD-3-Clause), which names as its source
// "DH parameters for calculations of kinematics and dynamics"; greatest torques: "Max. joint torques", both
// articles of Universal Robots.  What the public set lacks (UR3, UR10) has its flange compared alone, and so
// has the UR3e, which does not get round this shoe.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cctype>
#include <random>

#include "host/robot/kinematics/chain.hpp"
#include "host/robot/path/plan.hpp"
#include "host/robot/path/scan_process.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"
#include "tests/unit/host/robot/peer/mujoco_arm.hpp"

namespace biteline::test {
namespace {

using kinematics::Joints;

constexpr const char* k_arms[] = {"UR5", "UR5e", "UR10e"};
/// Of a scanning head, which tells none: what docs/build-a-sensor.md's parts come to, well above.
const path::Payload k_head{.mass_kg = 2, .centre_flange_mm = Vec3(0, 60, 120)};

/// The largest share of its limit that a joint needs.
double most_torque_ratio(MujocoArm& peer, const Joints& most_nm, const path::CheckedPath& path) {
  const std::vector<path::Waypoint>& w = path.path().waypoints;
  double most = 0;
  for (std::size_t i = 1; i + 1 < w.size(); ++i) {
    const double before_s = w[i].time_s - w[i - 1].time_s, behind_s = w[i + 1].time_s - w[i].time_s;
    if (before_s <= 0 || behind_s <= 0) continue;
    const Joints before = (w[i].q_rad - w[i - 1].q_rad) / before_s,
                 behind = (w[i + 1].q_rad - w[i].q_rad) / behind_s;
    const Joints torques_nm =
        peer.torques(w[i].q_rad, (behind_s * before + before_s * behind) / (before_s + behind_s),
                     2 * (behind - before) / (before_s + behind_s));
    most = std::max(most, torques_nm.cwiseAbs().cwiseQuotient(most_nm).maxCoeff());
  }
  return most;
}

path::PlanOutcome planned(const char* arm, path::Process process) {
  return path::plan({.line = path::test::made_line(),
                     .process = std::move(process),
                     .arm = *kinematics::arm_model(arm),
                     .T_line_base = SE3::Identity(),
                     .table_z_mm = 0,
                     .shoe = {},
                     .cloud = {}});
}

std::optional<LinkBodies> public_bodies(std::string arm) {
  std::ranges::transform(arm, arm.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto folder = shared_data("robot/ur_description/" + arm);
  if (!folder) return std::nullopt;
  note_ran();
  return read_link_bodies(*folder);
}

/// Some torque is needed, and none beyond the limit.
void expect_within_limits(const char* arm, const char* what, const path::Payload& payload,
                          const path::PlanOutcome& outcome) {
  const std::optional<LinkBodies> bodies = public_bodies(arm);
  if (!bodies) return;
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  MujocoArm peer{*kinematics::arm_model(arm), bodies, payload};
  const double ratio = most_torque_ratio(peer, bodies->most_nm, *outcome.path);
  UT_PRINT(StringFromFormat("%s, %s: %.0f %% of a joint's greatest torque", arm, what, 100 * ratio)
               .asCharString());
  CHECK(ratio > 0.02);
  CHECK(ratio < 1);
}

/// A head that reaches over the shoe's far side: the beam at right angles to the flange.
geometry::SensorModel reaching_head() {
  geometry::SensorModel sensor;
  sensor.laser_plane.normal_cam = Vec3{0, 1, -1}.normalized();
  sensor.laser_plane.distance_mm = sensor.laser_plane.normal_cam.dot(Vec3{0, 0, 200});
  SE3 T_tcp_flange = SE3::Identity();
  T_tcp_flange.linear() = Eigen::AngleAxisd{-1.0, Vec3::UnitX()}.toRotationMatrix();
  T_tcp_flange.translation() = Vec3{0, -160, -150};
  const path::Process plain = *path::scan_process(sensor, {});
  sensor.T_flange_cam = T_tcp_flange.inverse() * plain.tool.T_flange_tcp.inverse() * sensor.T_flange_cam;
  return sensor;
}

}  // namespace

TEST_GROUP(MujocoPeer){};

TEST(MujocoPeer, HasTheFlangeOfEveryArmWhereOursHasIt) {
  std::mt19937 random{1};
  std::uniform_real_distribution<double> angle_rad{-6, 6};
  for (const std::string& name : kinematics::arm_names()) {
    const kinematics::ArmModel arm = *kinematics::arm_model(name);
    MujocoArm peer{arm};
    for (int i = 0; i < 300; ++i) {
      const Joints q_rad = Joints::NullaryExpr([&] { return angle_rad(random); });
      const SE3 ours = kinematics::forward(arm, q_rad), theirs = peer.T_base_flange(q_rad);
      DOUBLES_EQUAL_TEXT(0, (ours.translation() - theirs.translation()).norm(), 0.001, name.c_str());
      DOUBLES_EQUAL_TEXT(0, (ours.linear() - theirs.linear()).norm(), 1e-6, name.c_str());
    }
  }
}

/// By hand: an arm stretched out level carries what hangs on its flange by its shoulder.
TEST(MujocoPeer, HoldsAPayloadByItsWeightTimesItsArm) {
  const kinematics::ArmModel arm = *kinematics::arm_model("UR10e");
  const auto shoulder_nm = [&](const path::Payload& payload) {
    const Joints stretched_rad = Joints::Zero();
    return MujocoArm{arm, {}, payload}.torques(stretched_rad, Joints::Zero(), Joints::Zero())[1];
  };
  const double beside_m = 1e-3 * kinematics::forward(arm, Joints::Zero()).translation().x();
  DOUBLES_EQUAL(std::abs(10 * 9.81 * beside_m), std::abs(shoulder_nm({.mass_kg = 10}) - shoulder_nm({})),
                1e-6);
}

TEST(MujocoPeer, NeedsNoMoreTorqueForAShippedProcessThanTheArmHas) {
  for (const char* arm : k_arms) {
    for (const char* name : {"spray", "cement", "grind", "rough"}) {
      path::Process process =
          *path::read_process(std::filesystem::path{BITELINE_PROCESSES} / (std::string{name} + ".yaml"));
      const path::Payload payload = process.tool.payload.value_or(path::Payload{});
      expect_within_limits(arm, name, payload, planned(arm, std::move(process)));
    }
  }
}

TEST(MujocoPeer, NeedsNoMoreTorqueForAScanThanTheArmHas) {
  expect_within_limits("UR10e", "scan", k_head, planned("UR10e", *path::scan_process(reaching_head(), {})));
}

}  // namespace biteline::test
