// SPDX-License-Identifier: MIT
#pragma once
/// \file Send a path, watch the arm follow it, and say how well it did.

#include <functional>
#include <optional>

#include "host/robot/link/ending.hpp"
#include "host/robot/link/halt.hpp"
#include "host/robot/link/robot_link.hpp"
#include "host/robot/path/track.hpp"

namespace biteline::robot {

struct FollowOptions {
  double start_patience_s{5};  ///< from sending to the program's first motion
  double way_there_rad{30};    ///< of the joints' way to the path's beginning, at its speed
  double slowest_ratio{0.05};  ///< of the planned speed over the whole run: the operator's slider
  /// Of a state. The word that stops an arm is on the wire 0.1 s after the state beyond a limit; a view that
  /// is older by as much again lets the arm go twice as far.
  double age_s{0.1};
  double rest_patience_s{2};      ///< from a stop to the arm at rest
  double output_patience_s{0.5};  ///< from a program's end or a stop to the tool's output seen off
  path::FollowLimits limits{};    ///< beyond one of them the arm is stopped
  /// Called at once when somebody at the pendant has taken the arm, before it is stopped.
  std::function<void()> taken{};
};

struct FollowReport {
  bool sent{false};                      ///< the path left for the controller
  std::vector<path::TrackSample> track;  ///< the whole run, time from the program's start
  path::TrackDeviation deviation;
  double duration_s{0};
  double slowest_speed_ratio{1};   ///< that the controller reported meanwhile
  std::optional<HaltReason> halt;  ///< why it is no done job
  double oldest_s{0};              ///< age of a state that was looked at
  Ending ending;                   ///< the arm at rest, the tool off: as it was seen
};

struct StillOptions {
  double patience_s{20};  ///< for what moves it to end
  double still_s{0.2};    ///< neither joints nor tip move for so long, by the controller's clock and by ours
  double turn_rad{1e-4};  ///< less is noise of the encoders
  double move_mm{0.1};
  std::optional<StopMark> mark{};  ///< stopped: waits no longer
};

/// Where the arm stands, once it stands.  Errc::Timeout when it goes on moving.
[[nodiscard]] Result<RobotState> wait_until_still(const RobotLink& link, const StillOptions& options);

/// Blocks until the program ends.  Each state is compared with the path; at the first one beyond a limit, and
/// on a stop by the safety system, a lost connection, a frozen or senseless state, too long a wait or a stop
/// since the path's order, the arm is told to stop and the reason returned: Errc::CheckFailed where the arm
/// was at fault, the device's code where the device was.  Success means: every state within the limits, the
/// line covered, the arm at rest, its tool's output off.  A run that is not done is stopped, whatever ended
/// it: a state that says "the program has ended" may be wrong.  `report` is filled as far as it went, also on
/// a failure.
[[nodiscard]] Result<void> follow(RobotLink& link, const PermittedPath& permitted,
                                  const FollowOptions& options, FollowReport& report);

/// One row per sample: time, T_base_tcp, the force on the tool in base axes (empty: not told).
[[nodiscard]] Result<void> write_track(const std::filesystem::path& file,
                                       const std::vector<path::TrackSample>& track);

}  // namespace biteline::robot
