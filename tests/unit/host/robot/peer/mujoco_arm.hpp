// SPDX-License-Identifier: MIT
#pragma once
/// \file Our arms in MuJoCo, an engine by other hands: flange and torques.

#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "host/robot/kinematics/arm_model.hpp"
#include "host/robot/path/process.hpp"

struct mjModel_;
struct mjData_;

namespace biteline::test {

/// Masses, centres, inertias and greatest torques of an arm's links, of a folder as ur_description has it.
struct LinkBodies {
  struct Link {
    double mass_kg;
    Vec3 centre_mm;      ///< in the frame that turns with the joint (ArmModel::T_fixed)
    Mat3 inertia_kg_m2;  ///< about the centre, in that frame's axes
  };
  std::array<Link, kinematics::k_joints> links;
  kinematics::Joints most_nm;
};
[[nodiscard]] LinkBodies read_link_bodies(const std::filesystem::path& folder);

/// Built as MJCF text from the arm's Denavit-Hartenberg lengths alone, one body a joint.  Without `bodies`
/// the links weigh a little something.
class MujocoArm {
 public:
  explicit MujocoArm(const kinematics::ArmModel& arm, const std::optional<LinkBodies>& bodies = {},
                     const path::Payload& payload = {});
  ~MujocoArm();
  MujocoArm(const MujocoArm&) = delete;
  MujocoArm& operator=(const MujocoArm&) = delete;

  [[nodiscard]] SE3 T_base_flange(const kinematics::Joints& q_rad);
  /// Nm, by inverse dynamics, gravity along base's -z.
  [[nodiscard]] kinematics::Joints torques(const kinematics::Joints& q_rad,
                                           const kinematics::Joints& speed_rad_s,
                                           const kinematics::Joints& acceleration_rad_s2);

 private:
  void set(const kinematics::Joints& q_rad, const kinematics::Joints& speed_rad_s,
           const kinematics::Joints& acceleration_rad_s2);

  std::unique_ptr<mjModel_, void (*)(mjModel_*)> model_;
  std::unique_ptr<mjData_, void (*)(mjData_*)> data_;
};

}  // namespace biteline::test
