// SPDX-License-Identifier: MIT
#include "host/robot/link/follow.hpp"

#include <algorithm>
#include <chrono>

#include "common/core/fixed_text.hpp"
#include "host/report/report.hpp"
#include "host/robot/link/path_watch.hpp"
#include "host/robot/link/ur/force_script.hpp"

namespace biteline::robot {
namespace {

// How soon a stop from outside, a frozen or a senseless state is noticed: a fifth of what the stop may take.
constexpr Nanoseconds k_look{20'000'000};
constexpr Nanoseconds k_first_state_patience{1'000'000'000};
constexpr double k_old_s = 0.1;
/// A controller that is asked again each tenth of a second.
constexpr double k_door_closed_s = 1;
/// A program's own time without a beat, 0.5 s, its braking from a joint's full way there, and two looks.
constexpr double k_dead_mans_work_s = 1.2;
/// A controller's clock goes as ours does, by parts in 10 000.
constexpr double k_shown_ratio = 0.5;
constexpr double k_shaking_rad = 0.01;  // of a joint at the end of its path: some 2 mm of the tip
// One state that says "no program runs" is not believed: so long all of them must, by both clocks.
constexpr double k_ended_s = 0.1;

double seconds(Nanoseconds duration) {
  return static_cast<double>(duration.count()) * 1e-9;
}

double seconds_since(HostClock::time_point instant) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return seconds(std::chrono::duration_cast<Nanoseconds>(now) - instant.time_since_epoch());
}

/// The code that tells what kind of thing stopped the arm: the exit status follows from it.
Errc errc_of(Halt halt) {
  switch (halt) {
    case Halt::Silent:
    case Halt::Unusable:
    case Halt::Old:
    case Halt::NotSent:
    case Halt::StopDoorClosed:
      return Errc::ConnectionLost;
    case Halt::ProtectiveStop:
      return Errc::InterlockOpen;
    case Halt::PowerOff:
      return Errc::DeviceLost;
    case Halt::NotStarted:
    case Halt::ProgramError:
      return Errc::PeerRefused;
    case Halt::NotEnded:
      return Errc::Timeout;
    case Halt::LocalControl:
    case Halt::Person:
      return Errc::Refused;
    case Halt::OffPath:
    case Halt::OffDirection:
    case Halt::OffWay:
    case Halt::OtherTool:
    case Halt::Late:
    case Halt::Stalled:
    case Halt::NotCovered:
    case Halt::NoContact:
    case Halt::ContactLost:
    case Halt::ForceTooHigh:
    case Halt::ForceOff:
    case Halt::FlangeDead:
      return Errc::CheckFailed;
    case Halt::ToolOn:
      return Errc::DeviceError;
  }
  return Errc::CheckFailed;
}

/// Stands so long on its way there.
double purge_s(const path::PlannedPath& path) {
  return path.purge_via && path.flow ? path.flow->purge_s + path.flow->gun_off_s : 0;
}

/// Watches one run, state by state.
class Run {
 public:
  Run(RobotLink& link, const PermittedPath& permitted, const FollowOptions& options, const RobotState& from)
      : link_{link},
        options_{options},
        mark_{permitted.mark()},
        watch_{permitted.path().path(), options.limits, from},
        longest_s_{options.way_there_rad / permitted.path().path().motion.way_there_rad_s +
                   purge_s(permitted.path().path()) + permitted.path().duration_s() / options.slowest_ratio},
        unusable_{link.status().unusable_states},
        sent_{from.received},
        newest_{from} {}

  /// Until the program has ended, or what must stop it.
  std::optional<HaltReason> watch(FollowReport& report) {
    while (true) {
      const Result<RobotState> state = link_.wait_newer(newest_.sequence, k_look);
      const bool newer = state && state->sampled > newest_.sampled;
      if (mark_.stopped()) return HaltReason{Halt::Person, "the service was told to stop"};
      if (link_.remote_control() == false) {
        if (options_.taken) options_.taken();
        return HaltReason{Halt::LocalControl, "the controller was put into local control"};
      }
      if (auto deaf = look_at_link(state)) return deaf;
      link_.beat();
      // An instant that was heard already, or an older one, says nothing about now.
      if (!newer) continue;
      report.oldest_s = std::max(report.oldest_s, state->age_s);
      if (auto old = look_at_age(*state)) return old;
      if (auto halt = look(*state)) return halt;
      if (!started_) continue;
      if (state->program_running) {
        ended_.reset();
        report.slowest_speed_ratio = std::min(report.slowest_speed_ratio, state->speed_ratio);
        continue;
      }
      if (!ended_) ended_ = *state;
      if (between_s(*ended_, *state) < k_ended_s) continue;
      report.duration_s = seconds(ended_->received - sent_);
      return ended_early();
    }
  }

 private:
  std::optional<HaltReason> look_at_link(const Result<RobotState>& state) {
    const LinkStatus status = link_.status();
    if (status.unusable_states > unusable_)
      return HaltReason{Halt::Unusable, "the controller sent a state without numbers"};
    if (!status.program_error.empty())
      return HaltReason{Halt::ProgramError, "the controller ends the program: " + status.program_error};
    if (status.stop_door_closed_s > k_door_closed_s)
      return HaltReason{Halt::StopDoorClosed,
                        "its script port takes no connection: a stop could not switch "
                        "the tool off"};
    // A controller that goes on sending the same instant is as silent as one that sends nothing.
    if (state && state->sampled > newest_.sampled) newest_ = *state;
    if (state) newest_.sequence = state->sequence;
    const double silent_s = seconds_since(newest_.received);
    if (silent_s <= options_.limits.silence_s) return std::nullopt;
    return HaltReason{Halt::Silent, std::string{FixedText<100>::format("no new state for %.2f s (limit %.2f)",
                                                                       silent_s, options_.limits.silence_s)
                                                    .view()}};
  }

  /// All states for a while: a host that stood still for a moment reads old ones, and then a young one.
  std::optional<HaltReason> look_at_age(const RobotState& state) {
    if (state.age_s <= options_.age_s) {
      old_since_.reset();
      return std::nullopt;
    }
    if (!old_since_) old_since_ = state.received;
    if (seconds(state.received - *old_since_) < k_old_s) return std::nullopt;
    return HaltReason{Halt::Old, std::string{FixedText<100>::format("its states are %.2f s old (limit %.2f)",
                                                                    state.age_s, options_.age_s)
                                                 .view()}};
  }

  std::optional<HaltReason> look(const RobotState& state) {
    if (state.safety == Safety::Stopped)
      return HaltReason{Halt::ProtectiveStop, "stopped by its safety system"};
    if (!state.powered) return HaltReason{Halt::PowerOff, "power or brakes went off"};
    const double waited_s = seconds(state.received - sent_);
    started_ = started_ || state.program_running;
    if (!started_) return waited_s > options_.start_patience_s ? not_started() : std::nullopt;
    if (waited_s > longest_s_) {
      return HaltReason{
          Halt::NotEnded,
          std::string{FixedText<100>::format("the program did not end within %.0f s", longest_s_).view()}};
    }
    return watch_.look(state);
  }

  /// Before the whole run is judged, which takes time: an arm whose program has not ended goes on meanwhile.
  std::optional<HaltReason> ended_early() const {
    // Such a program ends itself; its last word stays in the controller's register.
    if (auto told = watch_.look_at_word(*ended_)) return told;
    if (watch_.to_come_mm() <= options_.limits.off_path_mm) return std::nullopt;
    // A controller says why it ended a program, and a program that was not watched any more does, too.
    const std::string text = link_.status().last_text;
    return HaltReason{Halt::NotCovered,
                      std::string{FixedText<250>::format(
                                      "the program ended %.0f mm before the path did%s%.120s",
                                      watch_.to_come_mm(), text.empty() ? "" : ", it says: ", text.c_str())
                                      .view()}};
  }

  std::optional<HaltReason> not_started() const {
    const std::string text = link_.status().last_text;
    return HaltReason{Halt::NotStarted,
                      std::string{FixedText<250>::format("the program did not start within %.0f s%s%.120s",
                                                         options_.start_patience_s,
                                                         text.empty() ? "" : ", it says: ", text.c_str())
                                      .view()}};
  }

  RobotLink& link_;
  const FollowOptions& options_;
  const StopMark mark_;
  PathWatch watch_;
  double longest_s_;
  std::uint64_t unusable_;
  HostClock::time_point sent_;
  RobotState newest_;  ///< by the controller's clock
  bool started_{false};
  std::optional<HostClock::time_point> old_since_;
  std::optional<RobotState> ended_;  ///< the first of those in a row that say that no program runs
};

/// The limits again over the whole track: a run is done only where this one agrees, too.
std::optional<HaltReason> judge(const path::TrackDeviation& deviation, const path::FollowLimits& limits) {
  if (deviation.completed && deviation.covered >= limits.covered && deviation.max_mm <= limits.off_path_mm &&
      deviation.max_rad <= limits.off_path_rad)
    return std::nullopt;
  const bool off = deviation.max_mm > limits.off_path_mm;
  return HaltReason{
      off ? Halt::OffPath : Halt::NotCovered,
      std::string{FixedText<200>::format(
                      "the program ended%s with %.1f %% of the line covered (limit %.1f), the "
                      "tip up to %.1f mm beside the path at %.0f mm (limit %.1f)",
                      deviation.completed ? "" : " before the path did,", 100 * deviation.covered,
                      100 * limits.covered, deviation.max_mm, deviation.max_at_mm, limits.off_path_mm)
                      .view()}};
}

/// The line is worked, and what did it is not at rest.
HaltReason not_ended(const Ending& ending) {
  if (!ending.tool_is_safe())
    return {Halt::ToolOn, "the path is done, and the tool's output is not seen off"};
  return {Halt::NotEnded, "the path is done, and the arm does not come to rest"};
}

/// Of states that show little of the time they came in nothing can be said of the arm.
tl::unexpected<Error> never_still(const RobotState& first, const RobotState& last) {
  const double heard_s = seconds(last.received - first.received);
  const double shown_s = seconds(last.sampled - first.sampled);
  if (shown_s < k_shown_ratio * heard_s) {
    return fail(Errc::Timeout,
                "robot: its states come late: in %.1f s they show %.1f s of its clock; see what holds them "
                "up: network, relay, a busy machine",
                heard_s, std::max(0.0, shown_s));
  }
  return fail(Errc::Timeout, "robot: it still moves after %.0f s", heard_s);
}

void fill(FollowReport& report, const std::vector<RobotState>& states, const path::CheckedPath& path) {
  std::optional<RobotClock::time_point> last;
  for (const RobotState& state : states) {
    // As the watch: an instant that was heard already, or an older one, is passed over.
    if (last && state.sampled <= *last) continue;
    last = state.sampled;
    report.track.push_back({.time_s = seconds(state.sampled - states.front().sampled),
                            .T_base_tcp = state.T_base_tcp,
                            .force_base_newton = state.force_base_newton,
                            .flange_ratio = state.flange_ratio,
                            .presses = state.force_word == static_cast<int>(ur::ForceWord::Presses)});
  }
  report.deviation = path::deviation(path.path(), report.track);
}

}  // namespace

Result<RobotState> wait_until_still(const RobotLink& link, const StillOptions& options) {
  BITELINE_ASSIGN(RobotState state, link.wait_newer(0, k_first_state_patience));
  const RobotState first = state;
  RobotState still_since = state;
  while (between_s(still_since, state) < options.still_s) {
    if (options.mark && options.mark->stopped())
      return fail(Errc::Refused, "robot: the service was told to stop");
    if (seconds(state.received - first.received) > options.patience_s) return never_still(first, state);
    BITELINE_ASSIGN(state, link.wait_newer(state.sequence, k_first_state_patience));
    const bool turned = !((state.q_rad - still_since.q_rad).cwiseAbs().maxCoeff() <= options.turn_rad);
    const bool moved =
        !((state.T_base_tcp.translation() - still_since.T_base_tcp.translation()).norm() <= options.move_mm);
    const bool restarted = state.sampled < still_since.sampled;
    if (turned || moved || restarted) still_since = state;
  }
  return state;
}

Result<void> follow(RobotLink& link, const PermittedPath& permitted, const FollowOptions& options,
                    FollowReport& report) {
  const path::CheckedPath& path = permitted.path();
  BITELINE_ASSIGN(const RobotState from, link.latest());
  link.start_recording();
  Run run{link, permitted, options, from};
  const Result<void> sent = link.send(permitted);
  if (!sent && !link.may_run()) {
    static_cast<void>(link.take_recording());
    return sent;
  }
  report.sent = true;
  if (sent) {
    report.halt = run.watch(report);
  } else {
    report.halt = HaltReason{Halt::NotSent, "the program did not leave whole: " + to_line(sent.error())};
  }
  const bool taken = report.halt && report.halt->code == Halt::LocalControl && link.has_dead_man();
  const EndingOptions ending{.rest_patience_s = options.rest_patience_s,
                             .output_patience_s = options.output_patience_s,
                             .digital_output = path.path().digital_output,
                             .dead_man_s = taken ? k_dead_mans_work_s : 0};
  if (report.halt) {
    report.ending = stop_run(link, ending);
  } else {
    // An arm that is as far off as it may be on its path may shake by that at its end.
    EndingOptions at_end = ending;
    at_end.move_mm = options.limits.off_path_mm;
    at_end.turn_rad = k_shaking_rad;
    report.ending = end_run(link, at_end);
  }
  fill(report, link.take_recording(), path);
  if (!report.halt) report.halt = judge(report.deviation, options.limits);
  if (report.halt && report.ending.stops == 0) report.ending = stop_run(link, ending);
  if (!report.halt && !report.ending.seen()) report.halt = not_ended(report.ending);
  if (!report.halt) return {};
  // First what a person must do now.
  if (const std::string alarm = alarm_of(report.ending); !alarm.empty())
    report.halt->reason = alarm + "; " + report.halt->reason;
  return fail(errc_of(report.halt->code), "robot: %.240s", report.halt->reason.c_str());
}

Result<void> write_track(const std::filesystem::path& file, const std::vector<path::TrackSample>& track) {
  std::string text =
      "#time [s],p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z [],f_x [N],f_y [N],f_z [N]\n";
  for (const path::TrackSample& sample : track) {
    const Vec3 p = sample.T_base_tcp.translation();
    const Eigen::Quaterniond q{sample.T_base_tcp.linear()};
    text += FixedText<200>::format("%.4f,%.5f,%.5f,%.5f,%.9f,%.9f,%.9f,%.9f,", sample.time_s, p.x(), p.y(),
                                   p.z(), q.w(), q.x(), q.y(), q.z())
                .view();
    if (const auto& f = sample.force_base_newton)
      text += FixedText<100>::format("%.3f,%.3f,%.3f", f->x(), f->y(), f->z()).view();
    else
      text += ",,";
    text += "\n";
  }
  return report::write_file_atomically(file, text);
}

}  // namespace biteline::robot
