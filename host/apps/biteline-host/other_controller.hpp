// SPDX-License-Identifier: MIT
#pragma once
/// \file An arm of another make, by the generic protocol: what the service sees and asks of it.

#include "host/apps/biteline-host/controller.hpp"

namespace biteline::service {

/// The arm that a path is planned for, and where it stands.
[[nodiscard]] ArmSeen see_other_arm(const robot::other::ArmLink& link, const kinematics::ArmModel& arm);

/// Make, model and serial number, and how far its pose is from that of its joints.  Errc::ConnectionLost: it
/// has not said which robot it is.
[[nodiscard]] Result<void> ask_other_arm(const robot::other::ArmLink& link, const kinematics::ArmModel& arm,
                                         const robot::RobotState& state, robot::ArmFacts& facts);

/// What is not looked at, since the protocol does not tell it, is said in one line.
[[nodiscard]] ControllerLook look_at_other_arm(const robot::other::ArmLink& link,
                                               const kinematics::ArmModel& arm, const std::string& serial);

}  // namespace biteline::service
