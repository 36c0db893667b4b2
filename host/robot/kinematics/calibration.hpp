// SPDX-License-Identifier: MIT
#pragma once
/// \file An arm's own factory calibration, as extracted from its controller.

#include <filesystem>

#include "host/robot/kinematics/arm_model.hpp"

namespace biteline::kinematics {

/// Applies a kinematics YAML as written by Universal Robots' calibration extractor for ROS: under
/// `kinematics` the joints shoulder, upper_arm, forearm, wrist_1, wrist_2, wrist_3 with x y z [m] and roll
/// pitch yaw [rad] each, and the controller's `hash`.  Refused when a joint stands further from the nominal
/// model than any arm of that kind does (the file belongs to another arm).
[[nodiscard]] Result<ArmModel> with_calibration(const ArmModel& arm, const std::filesystem::path& file);

/// Errc::BadValue when a joint's fixed part stands further from the nominal model than any arm of that kind
/// has it.  `where`: names the source in the message.
[[nodiscard]] Result<void> expect_near_nominal(const ArmModel& arm, const std::string& where);

}  // namespace biteline::kinematics
