// SPDX-License-Identifier: MIT
#pragma once
/// \file The arm's controller as the service reaches it: where it is, what it says of itself and of its arm.

#include <memory>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"
#include "host/robot/kinematics/arm_model.hpp"
#include "host/robot/link/gate/gate.hpp"
#include "host/robot/link/other/arm_link.hpp"
#include "host/robot/link/ur/controller_door.hpp"
#include "host/robot/link/ur/ur_link.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::service {

/// For an answer of the controller about itself.
inline constexpr Nanoseconds k_door_patience{2'000'000'000};

struct ControllerAddress {
  std::string rtde;         ///< HOST:PORT
  std::string script;       ///< HOST:PORT
  std::string dashboard;    ///< HOST:PORT; empty: port 29999 of the script's machine
  std::string robot_api{};  ///< HOST:PORT of a PolyScope X; empty: port 80 of the script's machine
  /// An arm of another make: the service's own connection, which holds it; nothing above counts then.
  std::shared_ptr<robot::other::ArmLink> other{};

  [[nodiscard]] std::string name() const { return other ? other->address() : script; }
};

struct HostPort {
  std::string host;
  std::uint16_t port{0};
};

/// "HOST:PORT"; Errc::InvalidArgument.
[[nodiscard]] Result<HostPort> parse_host_port(const std::string& text);

/// A link to the arm, or the one that there is.  `connect_patience_s`: for its first state.  `claim`: of the
/// dead man; outlives the link.  `ask_force`: for a path that presses;
/// `flange_input`: standard analog input of the flange that it presses by, -1: none.
[[nodiscard]] Result<std::shared_ptr<robot::RobotLink>> open_robot(
    const ControllerAddress& controller,
    double connect_patience_s = robot::ur::UrLink::Config{}.connect_patience_s,
    robot::ur::ArmClaim* claim = nullptr, bool ask_force = false, int flange_input = -1);

/// Where it is asked about itself.  Of dashboard and Robot API the one that is told, or both; without being
/// told, both at the usual ports beside the script's.
[[nodiscard]] Result<robot::ur::DoorPlaces> doors_of(const ControllerAddress& controller);

/// The arm that a path is planned for.
struct ArmSeen {
  /// With its own kinematics where its controller tells them, and where they agree with the tip that it
  /// tells; else the nominal one.
  kinematics::ArmModel arm;
  /// Its joints now [rad], for a path that begins near to them.  A command and no check: follow_path() looks
  /// again.
  std::optional<kinematics::Joints> q_rad{};
  std::optional<SE3> T_flange_tcp{};  ///< the tool that the controller reckons with now
};

/// What the controller tells within half a second; what it does not tell stays nominal, and that is said in
/// one line when it is new.
[[nodiscard]] ArmSeen see_arm(const ControllerAddress& controller, const kinematics::ArmModel& nominal);

/// By name what differs between a process's tool and the controller's, as it was set up at the pendant or by
/// the program before; empty: they agree within 1 mm and 1 degree.  The path's program sets the process's.
[[nodiscard]] std::string tool_difference(const path::Process& process, const SE3& T_flange_tcp);
/// Says it in one line when it is new.
void say_tool_difference(const path::Process& process, const SE3& T_flange_tcp);

/// What the controller says about itself, and of an arm of another make how far its pose is from that of its
/// joints.  \param state its newest  Errc::ConnectionLost and others: it does not answer
[[nodiscard]] Result<void> ask_about_itself(const ControllerAddress& controller,
                                            const kinematics::ArmModel& arm, const robot::RobotState& state,
                                            robot::ArmFacts& facts);

/// What the controller says about itself before a scan, on stdout too; and whether the arm stands, so that no
/// light goes on while an older program still moves it.
struct ControllerLook {
  Result<robot::ur::ControllerWords> words;
  std::string wrong;  ///< what is known to be wrong, and what to do; empty: nothing
  bool moves{false};  ///< it is only that the arm does not stand yet
};
[[nodiscard]] ControllerLook look_at_controller(const ControllerAddress& controller,
                                                const kinematics::ArmModel& arm, const std::string& serial);

/// Says it in one line when it is something new of that subject.
void say_when_new(const std::string& subject, const std::string& words);

}  // namespace biteline::service
