// SPDX-License-Identifier: MIT
#include "tests/unit/host/robot/peer/mujoco_arm.hpp"

#include <mujoco/mujoco.h>
#include <yaml-cpp/yaml.h>

#include <cstdarg>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <stdexcept>

#include "host/robot/kinematics/chain.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::test {
namespace {

constexpr double k_m_per_mm = 1e-3;
/// Of links whose masses are not told: the engine wants some.
constexpr double k_some_kg = 1;

std::string format(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string format(const char* format, ...) {
  char text[400];
  va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return text;
}

/// The makers' convention: from a joint's frame to the next one, Tz(d) Tx(a) Rx(alpha) behind Rz(q).
struct DhStep {
  double d_mm, a_mm, alpha_rad;
  [[nodiscard]] SE3 transform() const {
    return Eigen::Translation3d(a_mm, 0, d_mm) * SE3(Eigen::AngleAxisd(alpha_rad, Vec3::UnitX()));
  }
};

std::array<DhStep, kinematics::k_joints> steps_of(const kinematics::DhLengths& lengths) {
  constexpr double k_right = std::numbers::pi / 2;
  return {{{lengths.d1_mm, 0, k_right},
           {0, lengths.a2_mm, 0},
           {0, lengths.a3_mm, 0},
           {lengths.d4_mm, 0, k_right},
           {lengths.d5_mm, 0, -k_right},
           {lengths.d6_mm, 0, 0}}};
}

std::string inertial(double mass_kg, const Vec3& centre_mm, const Mat3& I) {
  const Vec3 at_m = k_m_per_mm * centre_mm;
  return format(
      "<inertial mass=\"%.9g\" pos=\"%.12g %.12g %.12g\" fullinertia=\"%.9g %.9g %.9g %.9g %.9g %.9g\"/>\n",
      mass_kg, at_m.x(), at_m.y(), at_m.z(), I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
}

/// Of the link behind the joint, in the body's frame: the two turn together and stand apart as at rest.
std::string link_inertial(const LinkBodies::Link& link, const SE3& T_body_link) {
  const Mat3 R = T_body_link.linear();
  return inertial(link.mass_kg, T_body_link * link.centre_mm, R * link.inertia_kg_m2 * R.transpose());
}

std::string mjcf(const kinematics::ArmModel& arm, const std::optional<LinkBodies>& bodies,
                 const path::Payload& payload) {
  constexpr double k_payload_radius_m = 0.05;
  const auto steps = steps_of(arm.nominal);
  const auto T_base_links = kinematics::joint_frames(arm, kinematics::Joints::Zero());
  std::string text =
      "<mujoco><compiler angle=\"radian\" autolimits=\"false\"/><option gravity=\"0 0 -9.81\"/><worldbody>\n";
  SE3 T_base_body = SE3::Identity();  // at rest
  SE3 T_before = SE3::Identity();
  for (std::size_t i = 0; i <= steps.size(); ++i) {
    const Vec3 at_m = k_m_per_mm * T_before.translation();
    const Eigen::Quaterniond turn{T_before.linear()};
    text += format("<body name=\"b%zu\" pos=\"%.12g %.12g %.12g\" quat=\"%.15g %.15g %.15g %.15g\">\n", i,
                   at_m.x(), at_m.y(), at_m.z(), turn.w(), turn.x(), turn.y(), turn.z());
    T_base_body = T_base_body * T_before;
    if (i == steps.size()) break;
    text += "<joint axis=\"0 0 1\"/>\n";
    text += bodies ? link_inertial(bodies->links[i], T_base_body.inverse(Eigen::Isometry) * T_base_links[i])
                   : inertial(k_some_kg, Vec3::Zero(), Mat3::Identity());
    T_before = steps[i].transform();
  }
  if (payload.mass_kg > 0) {
    const double about = 0.4 * payload.mass_kg * k_payload_radius_m * k_payload_radius_m;
    text += inertial(payload.mass_kg, payload.centre_flange_mm, about * Mat3::Identity());
  }
  for (std::size_t i = 0; i <= steps.size(); ++i) text += "</body>";
  return text + "\n</worldbody></mujoco>\n";
}

mjModel* load(const std::string& text) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "arm.xml";
  std::ofstream{file} << text;
  char reason[1000] = "";
  mjModel* model = mj_loadXML(file.c_str(), nullptr, reason, sizeof reason);
  if (model == nullptr) throw std::runtime_error{reason};
  return model;
}

Mat3 turned(const YAML::Node& rpy) {
  return (Eigen::AngleAxisd(rpy["yaw"].as<double>(), Vec3::UnitZ()) *
          Eigen::AngleAxisd(rpy["pitch"].as<double>(), Vec3::UnitY()) *
          Eigen::AngleAxisd(rpy["roll"].as<double>(), Vec3::UnitX()))
      .toRotationMatrix();
}

}  // namespace

LinkBodies read_link_bodies(const std::filesystem::path& folder) {
  constexpr std::array k_links{"shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"};
  constexpr std::array k_joints{"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};
  const YAML::Node told = YAML::LoadFile(folder / "physical_parameters.yaml")["inertia_parameters"];
  const YAML::Node limits = YAML::LoadFile(folder / "joint_limits.yaml")["joint_limits"];
  LinkBodies bodies;
  for (std::size_t i = 0; i < k_links.size(); ++i) {
    const std::string name = k_links[i];
    const YAML::Node at = told["center_of_mass"][name + "_cog"], I = told["tensor"][name];
    const auto of = [&](const char* key) { return I[key].as<double>(); };
    Mat3 tensor;
    tensor << of("ixx"), of("ixy"), of("ixz"), of("ixy"), of("iyy"), of("iyz"), of("ixz"), of("iyz"),
        of("izz");
    const Mat3 R = turned(told["rotation"][name]);
    bodies.links[i] = {
        .mass_kg = told[name + "_mass"].as<double>(),
        .centre_mm = 1000 * Vec3(at["x"].as<double>(), at["y"].as<double>(), at["z"].as<double>()),
        .inertia_kg_m2 = R * tensor * R.transpose()};
    bodies.most_nm[static_cast<Eigen::Index>(i)] = limits[k_joints[i]]["max_effort"].as<double>();
  }
  return bodies;
}

MujocoArm::MujocoArm(const kinematics::ArmModel& arm, const std::optional<LinkBodies>& bodies,
                     const path::Payload& payload)
    : model_{load(mjcf(arm, bodies, payload)), &mj_deleteModel},
      data_{mj_makeData(model_.get()), &mj_deleteData} {}

MujocoArm::~MujocoArm() = default;

void MujocoArm::set(const kinematics::Joints& q_rad, const kinematics::Joints& speed_rad_s,
                    const kinematics::Joints& acceleration_rad_s2) {
  for (Eigen::Index i = 0; i < q_rad.size(); ++i) {
    data_->qpos[i] = q_rad[i];
    data_->qvel[i] = speed_rad_s[i];
    data_->qacc[i] = acceleration_rad_s2[i];
  }
}

SE3 MujocoArm::T_base_flange(const kinematics::Joints& q_rad) {
  set(q_rad, kinematics::Joints::Zero(), kinematics::Joints::Zero());
  mj_kinematics(model_.get(), data_.get());
  const int flange = mj_name2id(model_.get(), mjOBJ_BODY, "b6");
  SE3 T = SE3::Identity();
  for (int row = 0; row < 3; ++row) {
    T.translation()[row] = data_->xpos[3 * flange + row] / k_m_per_mm;
    for (int col = 0; col < 3; ++col) T.linear()(row, col) = data_->xmat[9 * flange + 3 * row + col];
  }
  return T;
}

kinematics::Joints MujocoArm::torques(const kinematics::Joints& q_rad, const kinematics::Joints& speed_rad_s,
                                      const kinematics::Joints& acceleration_rad_s2) {
  set(q_rad, speed_rad_s, acceleration_rad_s2);
  mj_inverse(model_.get(), data_.get());
  kinematics::Joints torques_nm;
  for (Eigen::Index i = 0; i < torques_nm.size(); ++i) torques_nm[i] = data_->qfrc_inverse[i];
  return torques_nm;
}

}  // namespace biteline::test
