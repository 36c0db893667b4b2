// SPDX-License-Identifier: MIT
#pragma once
/// \file Send a path, watch the arm follow it, and say how well it did.

#include "host/robot/link/robot_link.hpp"
#include "host/robot/path/track.hpp"

namespace biteline::robot {

struct FollowOptions {
  double start_patience_s{5};  ///< from sending to the program's first motion
  double way_there_s{60};      ///< for the arm's way to the path's beginning
  double slowest_ratio{0.1};   ///< of the planned speed: the operator's slider
};

struct FollowReport {
  std::vector<path::TrackSample> track;  ///< the whole run, time from the program's start
  path::TrackDeviation deviation;
  double duration_s{0};
  double slowest_speed_ratio{1};  ///< that the controller reported meanwhile
};

struct StillOptions {
  double patience_s{20};  ///< for what moves it to end
  double still_s{0.2};    ///< neither joints nor tip move for so long
  double turn_rad{1e-4};  ///< less is noise of the encoders
  double move_mm{0.1};
};

/// Where the arm stands, once it stands.  Errc::Timeout when it goes on moving.
[[nodiscard]] Result<RobotState> wait_until_still(const RobotLink& link, const StillOptions& options);

/// Blocks until the program ends.  On a stop by the safety system, a lost connection or too long a wait the
/// arm is told to stop and the reason returned.  `report` is filled as far as it went, also then.
[[nodiscard]] Result<void> follow(RobotLink& link, const path::CheckedPath& path,
                                  const FollowOptions& options, FollowReport& report);

/// One row per sample: time, T_base_tcp.
[[nodiscard]] Result<void> write_track(const std::filesystem::path& file,
                                       const std::vector<path::TrackSample>& track);

}  // namespace biteline::robot
