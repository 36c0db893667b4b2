// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/calibration.hpp"

#include "common/config/yaml_reader.hpp"
#include "host/robot/kinematics/chain.hpp"

namespace biteline::kinematics {
namespace {

constexpr std::array<const char*, k_joints> k_joint_names{"shoulder", "upper_arm", "forearm",
                                                          "wrist_1",  "wrist_2",   "wrist_3"};
constexpr double k_mm_per_m = 1000;

// Published calibrations differ from the nominal by up to 3 mm and 0.01 rad per joint; the closest two kinds
// of arm (UR5 and UR5e) by 24 mm.
constexpr double k_max_shift_mm = 10;
constexpr double k_max_turn_rad = 0.05;

SE3 frame_from(config::YamlReader& joint) {
  const auto metres = [&](const char* key) {
    return joint.number(key, {.minimum = -2, .maximum = 2}) * k_mm_per_m;
  };
  const auto angle_rad = [&](const char* key) { return joint.number(key, {.minimum = -7, .maximum = 7}); };
  SE3 T = SE3::Identity();
  T.translation() = Vec3{metres("x"), metres("y"), metres("z")};
  // URDF's fixed-axis roll, pitch, yaw.
  const double roll_rad = angle_rad("roll"), pitch_rad = angle_rad("pitch"), yaw_rad = angle_rad("yaw");
  T.linear() = (Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ()) * Eigen::AngleAxisd(pitch_rad, Vec3::UnitY()) *
                Eigen::AngleAxisd(roll_rad, Vec3::UnitX()))
                   .toRotationMatrix();
  return T;
}

}  // namespace

Result<void> expect_near_nominal(const ArmModel& arm, const std::string& where) {
  const std::array<SE3, k_joints> nominal = nominal_frames(arm.nominal);
  for (std::size_t i = 0; i < k_joints; ++i) {
    const SE3 T_nominal_calibrated = nominal[i].inverse() * arm.T_fixed[i];
    const double shift_mm = T_nominal_calibrated.translation().norm();
    const double turn_rad = geometry::log_so3(T_nominal_calibrated.linear()).norm();
    if (!(shift_mm <= k_max_shift_mm && turn_rad <= k_max_turn_rad)) {
      return fail(Errc::BadValue,
                  "%.120s: %s is %.1f mm and %.3f rad off a %s; the calibration of another arm?",
                  where.c_str(), k_joint_names[i], shift_mm, turn_rad, arm.name.c_str());
    }
  }
  return {};
}

Result<ArmModel> with_calibration(const ArmModel& arm, const std::filesystem::path& file) {
  BITELINE_ASSIGN(config::YamlReader reader, config::YamlReader::open(file));
  ArmModel calibrated = arm;
  {
    config::YamlReader joints = reader.child("kinematics", true);
    for (std::size_t i = 0; i < k_joints; ++i) {
      config::YamlReader joint = joints.child(k_joint_names[i], true);
      calibrated.T_fixed[i] = frame_from(joint);
    }
    static_cast<void>(joints.text_or("hash", ""));
  }
  BITELINE_TRY(reader.finish());

  BITELINE_TRY(expect_near_nominal(calibrated, file.string()));
  calibrated.calibrated = true;
  return calibrated;
}

}  // namespace biteline::kinematics
