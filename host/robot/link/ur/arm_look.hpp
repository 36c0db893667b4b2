// SPDX-License-Identifier: MIT
#pragma once
/// \file Where an arm stands and what its controller says it carries: read for teaching, nothing is sent.

#include <cstdint>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/robot/link/robot_link.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::robot::ur {

struct ArmLook {
  SE3 T_base_flange{SE3::Identity()};
  Vec3 tip_flange{Vec3::Zero()};  ///< the controller's own, mm
  std::optional<path::Payload> payload{};
};

/// Errc::WrongState where the arm still moves after a second.
[[nodiscard]] Result<ArmLook> look_at_arm(const RobotLink& link);

/// Errc::WrongState where the arm still moves after a second.  Takes up to some seconds.
[[nodiscard]] Result<ArmLook> look_at_arm(const std::string& host, std::uint16_t rtde_port);

}  // namespace biteline::robot::ur
