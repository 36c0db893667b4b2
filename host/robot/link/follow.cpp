// SPDX-License-Identifier: MIT
#include "host/robot/link/follow.hpp"

#include <algorithm>

#include "common/core/fixed_text.hpp"
#include "host/report/report.hpp"

namespace biteline::robot {
namespace {

// A controller sends 125 or 500 states a second; a second without one is a lost link.
constexpr Nanoseconds k_state_patience{1'000'000'000};

double seconds(Nanoseconds duration) {
  return static_cast<double>(duration.count()) * 1e-9;
}

/// Waits until the program runs, then until it has ended.
Result<void> watch(RobotLink& link, const path::CheckedPath& path, const FollowOptions& options,
                   FollowReport& report) {
  BITELINE_ASSIGN(RobotState state, link.latest());
  const HostClock::time_point sent = state.received;
  const double longest_s = options.way_there_s + path.duration_s() / options.slowest_ratio;
  bool started = false;
  while (true) {
    BITELINE_ASSIGN(state, link.wait_newer(state.sequence, k_state_patience));
    const double waited_s = seconds(state.received - sent);
    if (state.safety == Safety::Stopped)
      return fail(Errc::InterlockOpen, "robot: stopped by its safety system");
    if (!state.powered) return fail(Errc::DeviceLost, "robot: power or brakes went off");
    started = started || state.program_running;
    if (started) report.slowest_speed_ratio = std::min(report.slowest_speed_ratio, state.speed_ratio);
    if (started && !state.program_running) {
      report.duration_s = waited_s;
      return {};
    }
    if (!started && waited_s > options.start_patience_s) {
      const std::string text = link.status().last_text;
      return fail(Errc::PeerRefused, "robot: the program did not start within %.0f s%s%.120s",
                  options.start_patience_s, text.empty() ? "" : ", it says: ", text.c_str());
    }
    if (waited_s > longest_s)
      return fail(Errc::Timeout, "robot: the program did not end within %.0f s", longest_s);
  }
}

void fill(FollowReport& report, const std::vector<RobotState>& states, const path::CheckedPath& path) {
  for (const RobotState& state : states) {
    report.track.push_back(
        {.time_s = seconds(state.sampled - states.front().sampled), .T_base_tcp = state.T_base_tcp});
  }
  report.deviation = path::deviation(path.path(), report.track);
}

}  // namespace

Result<RobotState> wait_until_still(const RobotLink& link, const StillOptions& options) {
  BITELINE_ASSIGN(RobotState state, link.wait_newer(0, k_state_patience));
  const RobotState first = state;
  RobotState still_since = state;
  while (seconds(state.received - still_since.received) < options.still_s) {
    if (seconds(state.received - first.received) > options.patience_s) {
      return fail(Errc::Timeout, "robot: it still moves after %.0f s", options.patience_s);
    }
    BITELINE_ASSIGN(state, link.wait_newer(state.sequence, k_state_patience));
    const bool turned = (state.q_rad - still_since.q_rad).cwiseAbs().maxCoeff() > options.turn_rad;
    const bool moved =
        (state.T_base_tcp.translation() - still_since.T_base_tcp.translation()).norm() > options.move_mm;
    if (turned || moved) still_since = state;
  }
  return state;
}

Result<void> follow(RobotLink& link, const path::CheckedPath& path, const FollowOptions& options,
                    FollowReport& report) {
  link.start_recording();
  const Result<void> sent = link.send(path);
  if (!sent) {
    static_cast<void>(link.take_recording());
    return sent;
  }
  const Result<void> watched = watch(link, path, options, report);
  fill(report, link.take_recording(), path);
  if (!watched) {
    static_cast<void>(link.stop());  // the first failure is the one to tell
    return watched;
  }
  if (!report.deviation.completed)
    return fail(Errc::PeerRefused, "robot: the program ended before the path did");
  return {};
}

Result<void> write_track(const std::filesystem::path& file, const std::vector<path::TrackSample>& track) {
  std::string text = "#time [s],p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z []\n";
  for (const path::TrackSample& sample : track) {
    const Vec3 p = sample.T_base_tcp.translation();
    const Eigen::Quaterniond q{sample.T_base_tcp.linear()};
    text += FixedText<200>::format("%.4f,%.5f,%.5f,%.5f,%.9f,%.9f,%.9f,%.9f\n", sample.time_s, p.x(), p.y(),
                                   p.z(), q.w(), q.x(), q.y(), q.z())
                .view();
  }
  return report::write_file_atomically(file, text);
}

}  // namespace biteline::robot
