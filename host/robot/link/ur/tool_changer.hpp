// SPDX-License-Identifier: MIT
#pragma once
/// \file A tool changer that the controller's digital lines command: asked for a tool, and believed when it
/// tells that this tool stands.
///
///     this host -- RTDE --> controller -- output "ask" -->  changer
///                                      <-- input "there" --
///
/// The changer turns its tools where the arm stands; nothing of it moves the arm.

#include <cstdint>
#include <string>

#include "common/core/result.hpp"
#include "host/robot/link/gate/stops.hpp"
#include "host/robot/path/mounted.hpp"

namespace biteline::robot::ur {

struct ChangerAddress {
  std::string host{"127.0.0.1"};
  std::uint16_t rtde_port{30004};
  double patience_s{20};  ///< from the question to a tool that stands
};

/// The wanted tool stands when its input alone of all places' is on, for 0.2 s.  Then the outputs stay as
/// they are; else the wanted one's is switched on and the others' off.  Nothing of the controller's other
/// outputs changes.  `in_the_way`: why nothing may turn now; empty: it may.
///
/// Nothing was asked for: Errc::ConnectFailed; Errc::CheckFailed: something is in the way.  Else no place is
/// asked for any more, as far as the controller can be reached, and nobody knows which tool stands:
/// Errc::Timeout: it does not come to stand; Errc::PeerRefused: another client sets the outputs;
/// Errc::WrongState: stopped; Errc::ConnectionLost.
[[nodiscard]] Result<void> change_tool(const ChangerAddress& at, const path::Changer& changer,
                                       const std::string& in_the_way, const StopMark& mark);

/// How far from the flange nothing may stand while the tools turn, mm: no tool of the changer reaches
/// farther.
[[nodiscard]] double room_to_change_mm(const path::Changer& changer, const path::Tool& tool);

}  // namespace biteline::robot::ur
