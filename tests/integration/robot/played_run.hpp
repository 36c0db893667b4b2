// SPDX-License-Identifier: MIT
#pragma once
/// \file A run over TCP against a controller that plays a path, and makes of its states what a test wants.
#include <CppUTest/TestHarness.h>

#include <optional>

#include "host/robot/link/follow.hpp"
#include "host/robot/link/ur/ur_link.hpp"
#include "tests/unit/host/robot/link/permitted.hpp"
#include "tests/unit/host/robot/link/played_path.hpp"

namespace biteline::robot::test {

// A CB3's rate by the controller's clock; the cycles themselves take some 2 ms, so that a path is over
// sooner.
inline constexpr double k_cycle_s = 0.008;
// By the controller's clock: from 0.5 m/s at 2.5 m/s^2.
inline constexpr double k_braking_s = 0.2;

/// What a controller makes of a good state.  `share`: of the path; below 0 on the way there.
using Lie = std::function<void(PlayedState&, double share)>;

struct Played {
  Result<void> followed;
  FollowReport report;
  FakeController::Times times;
  std::string script;
  FakeController::Clock::time_point returned;
  int script_connections{0};
  double gone_mm{0};  ///< the tip's way from the first lie until the arm stood
};

inline double seconds_between(FakeController::Clock::time_point a, FakeController::Clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

struct PlayedRun : Utest {
  const path::CheckedPath& path = planned_path("grind.yaml");
  kinematics::Joints home_rad =
      path.path().waypoints.front().q_rad + (kinematics::Joints() << 0.6, -0.2, 0.1, 0, 0.2, -0.3).finished();
  Stops said;
  path::FollowLimits limits{};
  /// Before the link is opened: what the controller is like.
  std::function<void(FakeController&)> prepare{};

  /// The arm follows at the plan's speed times `pace`; what is sent goes through `lie`.
  Played play(const Lie& lie, double pace = 1) {
    const PlayedPath played{path.path(), home_rad};
    double last_s = 0, stop_s = -1, braked_s = 0;
    std::optional<Vec3> lie_at_m, rest_at_m;  // where the arm truly was
    std::optional<FakeController> controller_there;
    FakeController& controller = controller_there.emplace(
        [&](PlayedState& state) {
          const double now_s = std::max(0.0, pace * state.since_script_s);
          // Told to stop it brakes evenly, and then stands where it is.
          if (!state.stopped) {
            last_s = stop_s = now_s;
          } else {
            const double since_s = std::min((now_s - stop_s) / pace, k_braking_s);
            const double way_s = pace * (since_s - since_s * since_s / (2 * k_braking_s));
            last_s += way_s - std::exchange(braked_s, way_s);
            state.rests = since_s >= k_braking_s;
          }
          played.fill(last_s, state);
          const bool runs = state.since_script_s > 0.1 && !state.rests && last_s < played.duration_s() + 0.2;
          state.runtime_state = runs ? 2 : 1;
          const Vec3 true_m{state.tcp_pose[0], state.tcp_pose[1], state.tcp_pose[2]};
          if (state.since_script_s >= 0) lie(state, played.share_at(last_s));
          if (state.lie && !lie_at_m) lie_at_m = true_m;
          if (state.rests && !rest_at_m) rest_at_m = true_m;
        },
        k_cycle_s);
    if (prepare) prepare(controller);
    const auto link = ur::UrLink::open({.host = "127.0.0.1",
                                        .rtde_port = controller.rtde_port(),
                                        .script_port = controller.script_port(),
                                        .dashboard_port = controller.dashboard_port(),
                                        .rate_hz = 0,
                                        .connect_patience_s = 20});
    CHECK_TEXT(link.has_value(), link ? "" : to_line(link.error()).c_str());
    Played out;
    out.followed = follow(**link, permitted(path, home_rad, said.now()), {.limits = limits}, out.report);
    out.returned = FakeController::Clock::now();
    out.times = controller.times();
    out.script = controller.script();
    out.script_connections = controller.script_connections;
    controller_there.reset();  // its thread wrote the places
    if (lie_at_m && rest_at_m) out.gone_mm = 1000 * (*rest_at_m - *lie_at_m).norm();
    return out;
  }
};

}  // namespace biteline::robot::test
