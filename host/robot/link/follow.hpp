// SPDX-License-Identifier: MIT
#pragma once
/// \file Send a path, watch the arm follow it, and say how well it did.

#include <optional>

#include "host/robot/link/halt.hpp"
#include "host/robot/link/robot_link.hpp"
#include "host/robot/path/track.hpp"

namespace biteline::robot {

struct FollowOptions {
  double start_patience_s{5};   ///< from sending to the program's first motion
  double way_there_rad{30};     ///< of the joints' way to the path's beginning, at its speed
  double slowest_ratio{0.1};    ///< of the planned speed: the operator's slider
  double rest_patience_s{2};    ///< from a stop to the arm at rest
  path::FollowLimits limits{};  ///< beyond one of them the arm is stopped
};

struct FollowReport {
  bool sent{false};                      ///< the path left for the controller
  std::vector<path::TrackSample> track;  ///< the whole run, time from the program's start
  path::TrackDeviation deviation;
  double duration_s{0};
  double slowest_speed_ratio{1};   ///< that the controller reported meanwhile
  std::optional<HaltReason> halt;  ///< why it is no done job
  bool at_rest{true};              ///< after a stop: the program has ended and the arm stands
};

struct StillOptions {
  double patience_s{20};  ///< for what moves it to end
  double still_s{0.2};    ///< neither joints nor tip move for so long, by the controller's clock and by ours
  double turn_rad{1e-4};  ///< less is noise of the encoders
  double move_mm{0.1};
  std::optional<StopMark> mark{};  ///< stopped: waits no longer
};

/// At its way's end an arm rings for some tenths of a second, at 8 to 20 Hz and by tenths of a millimetre. So
/// much of turn_rad and move_mm is enough to send a path: a ninth of what the gate lets an arm move between
/// the check of its way and the sending (path::GateLimits::start_rad), and 2 mm/s for an arm that creeps.
inline constexpr double k_ringing_rad = 4e-4, k_ringing_mm = 0.4;

/// Where the arm stands, once it stands.  Errc::Timeout when it goes on moving.
[[nodiscard]] Result<RobotState> wait_until_still(const RobotLink& link, const StillOptions& options);

/// Blocks until the program ends.  Each state is compared with the path; at the first one beyond a limit, and
/// on a stop by the safety system, a lost connection, a frozen or senseless state, too long a wait or a stop
/// since the path's order, the arm is told to stop and the reason returned: Errc::CheckFailed where the arm
/// was at fault, the device's code where the device was.  Success means: every state within the limits and
/// the line covered.  `report` is filled as far as it went, also on a failure.
[[nodiscard]] Result<void> follow(RobotLink& link, const PermittedPath& permitted,
                                  const FollowOptions& options, FollowReport& report);

/// One row per sample: time, T_base_tcp.
[[nodiscard]] Result<void> write_track(const std::filesystem::path& file,
                                       const std::vector<path::TrackSample>& track);

}  // namespace biteline::robot
