// SPDX-License-Identifier: MIT
#pragma once
/// \file ABB EGM: the measured pose in one message of the controller (EgmRobot, Protocol Buffers 2).
///
/// From the published `egm.proto`, "ABB sensor interface V1.1".  Read are header (seqno, tm, mtype), feedBack
/// (cartesian: pos, orient; time) and rapidExecState; what else is there is skipped.

#include <cstdint>
#include <span>

#include "common/core/result.hpp"
#include "hal/linux/udp_poses/told_pose.hpp"

namespace biteline::hal {

/// The flange in base where the controller streams with tool0 and wobj0: mm, and a quaternion (u0 the real
/// part) that may be off length 1 by 0.001.  The stamp is feedBack.time, of software before RobotWare 6.07
/// header.tm.
/// Errc::ProtocolError: no such message; Errc::BadFormat: it has no measured pose or no stamp;
/// Errc::BadValue: numbers that are no pose.  Memory: none.
[[nodiscard]] Result<ToldPose> read_egm(std::span<const std::uint8_t> message);

}  // namespace biteline::hal
