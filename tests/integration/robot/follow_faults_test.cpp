// SPDX-License-Identifier: MIT
// Controllers that lie, freeze and fail while their arm follows: each is a row of
// tests/integration/faults/ROBOT.md.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>

#include "tests/integration/robot/played_run.hpp"
#include "tests/support/timed_test.hpp"
#include "tests/unit/host/robot/link/said_bytes.hpp"

namespace biteline::robot {
namespace {

using test::FakeController;
using test::Lie;
using test::Played;
using test::PlayedState;
using test::seconds_between;

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double k_deg = std::numbers::pi / 180;
// From the first state beyond a limit to the stop on the wire: a safety reaction.
constexpr double k_stop_within_s = 0.1;
// And until the host knows the arm at rest, less the arm's own braking.
constexpr double k_rest_within_s = 0.3;

/// What of the process file the halt stands for.
std::string limit_of(Halt halt, const path::FollowLimits& limits) {
  const auto number = [](const char* pattern, double value) {
    char text[40];
    std::snprintf(text, sizeof text, pattern, value);
    return std::string{text};
  };
  switch (halt) {
    case Halt::OffPath:
      return number("%g mm", limits.off_path_mm);
    case Halt::OffDirection:
      return number("%.0f degrees", limits.off_path_rad / k_deg);
    case Halt::OffWay:
      return number("%.0f degrees in a joint", limits.off_way_rad / k_deg);
    case Halt::Silent:
      return number("%g s", limits.silence_s);
    case Halt::Stalled:
      return number("%g s", limits.stall_s);
    case Halt::Late:
      return number("%g s and a quarter", limits.late_s);
    default:
      return "-";
  }
}

/// A lie that begins at a share of the path and stays.
Lie from(double begin, const std::function<void(PlayedState&)>& change) {
  return [begin, change](PlayedState& state, double share) {
    if (share < begin || state.stopped) return;
    state.lie = true;
    change(state);
  };
}

/// The controller's tip moved by mm.
void move(PlayedState& state, double x_mm, double y_mm, double z_mm) {
  state.tcp_pose[0] += x_mm / 1000;
  state.tcp_pose[1] += y_mm / 1000;
  state.tcp_pose[2] += z_mm / 1000;
}

void turn(PlayedState& state, double rad) {
  SE3 pose = ur::from_ur_pose(state.tcp_pose);
  pose.linear() = pose.linear() * geometry::exp_so3(Vec3{rad, 0, 0});
  state.tcp_pose = ur::to_ur_pose(pose);
}

}  // namespace

TEST_GROUP_BASE(FollowFaults, test::PlayedRun){
    /// The arm is stopped for `expected`, in time, and its tool with it.
    Played stops(const char* name, Halt expected, const Lie& lie, double noticed_within_s = 0,
                 double pace = 1){const Played out = play(lie, pace);
CHECK_TEXT(!out.followed.has_value(), name);
CHECK_TEXT(out.report.halt.has_value(), name);
STRCMP_EQUAL_TEXT(report::refusal_row(expected).name, report::refusal_row(out.report.halt->code).name, name);
CHECK_TEXT(out.times.stop.has_value(), name);
CHECK_TEXT(out.times.output_off.has_value(), name);
CHECK_TEXT(out.times.lie.has_value(), name);
const double delay_s = seconds_between(*out.times.lie, *out.times.stop);
std::printf("%s: %s\n", name, to_line(out.followed.error()).c_str());
CHECK_TEXT(delay_s <= noticed_within_s + k_stop_within_s, name);
CHECK_TEXT(delay_s >= 0, name);
CHECK_TEXT(out.report.ending.at_rest, name);
CHECK_TEXT(out.times.rest.has_value(), name);
const double braking_s = seconds_between(*out.times.stop, *out.times.rest);
const double rest_s = seconds_between(*out.times.lie, out.returned);
// A row of the table in tests/integration/faults/ROBOT.md.
std::printf("| %s | `%s` | %s | %.0f | %.0f | %.1f |\n", name, report::refusal_row(expected).name,
            limit_of(expected, limits).c_str(), 1000 * delay_s, 1000 * rest_s, out.gone_mm);
CHECK_TEXT(rest_s <= noticed_within_s + k_rest_within_s + braking_s, name);
CHECK_TEXT(out.returned >= *out.times.rest, name);
return out;
}  // namespace biteline::robot

static void has_status_3(const Played& out) {
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused),
              static_cast<int>(error_row(out.followed.error().code).exit_status));
}
}
;

TEST(FollowFaults, ArmThatKeepsToThePathIsDone) {
  const Played out = play([](PlayedState&, double) {});
  CHECK_TEXT(out.followed.has_value(), out.followed ? "" : to_line(out.followed.error()).c_str());
  CHECK(!out.report.halt);
  CHECK(!out.times.stop);
  DOUBLES_EQUAL(1.0, out.report.deviation.covered, 0.01);
}

TEST(FollowFaults, SmallErrorsOfARealArmAreNoReasonToStop) {
  int count = 0;
  const Played out = play([&count](PlayedState& state, double) {
    // 0.6 mm to and fro and a degree: an arm that lags, blends, shakes.
    const double wave = std::sin(0.3 * ++count);
    move(state, 0.4 * wave, 0.4 * wave, 0);
    turn(state, 1 * k_deg * wave);
  });
  CHECK_TEXT(out.followed.has_value(), out.followed ? "" : to_line(out.followed.error()).c_str());
}

ORDINARY_TIMED_TEST(FollowFaults, TipBesideThePathStopsTheArm) {
  has_status_3(stops("80 mm below from 20 % on", Halt::OffPath,
                     from(0.2, [](PlayedState& s) { move(s, 0, 0, -80); })));
  stops("20 mm aside, both ways", Halt::OffPath, from(0.22, [](PlayedState& s) { move(s, 20, 20, 0); }));
  stops("3 mm, a little beyond the limit", Halt::OffPath,
        from(0.22, [](PlayedState& s) { move(s, 0, 0, 3); }));
  stops("on the approach", Halt::OffPath, from(0.01, [](PlayedState& s) { move(s, 5, 0, 0); }));
  stops("on the retreat", Halt::OffPath, from(0.98, [](PlayedState& s) { move(s, 0, 5, 0); }));
}

ORDINARY_TIMED_TEST(FollowFaults, TipThatDriftsOffSlowlyIsStoppedAtTheLimit) {
  stops("drift of 1 mm in 10 mm", Halt::OffPath, [](PlayedState& state, double share) {
    if (share < 0.22 || state.stopped) return;
    const double drift_mm = 60 * (share - 0.22);
    move(state, 0, 0, drift_mm);
    state.lie = drift_mm > path::FollowLimits{}.off_path_mm;
  });
}

ORDINARY_TIMED_TEST(FollowFaults, JumpOfOneStateStopsTheArm) {
  bool jumped = false;
  stops("1.7 m for one state", Halt::OffPath, [&jumped](PlayedState& state, double share) {
    if (share < 0.22 || std::exchange(jumped, true)) return;
    state.lie = true;
    move(state, 1000, 1000, 1000);
  });
  // Along the path, where every place is a right one: only the time between the states tells.
  const test::PlayedPath played{path.path(), home_rad};
  stops("60 mm ahead along the path", Halt::OffPath, [&](PlayedState& state, double share) {
    if (share < 0.22 || state.stopped) return;
    state.lie = true;
    const std::uint32_t runtime = state.runtime_state;
    played.fill(played.way_s() + (share + 0.1) * (played.duration_s() - played.way_s()), state);
    state.runtime_state = runtime;
  });
}

ORDINARY_TIMED_TEST(FollowFaults, TurnedToolStopsTheArm) {
  stops("tool turned by 5 degrees", Halt::OffDirection,
        from(0.22, [](PlayedState& s) { turn(s, 5 * k_deg); }));
  stops("tool upside down", Halt::OffDirection, from(0.2, [](PlayedState& s) { turn(s, std::numbers::pi); }));
}

ORDINARY_TIMED_TEST(FollowFaults, JointBesideTheWayThereStopsTheArm) {
  const auto on_the_way = [](const std::function<void(PlayedState&)>& change) {
    return [change](PlayedState& state, double share) {
      if (share > -0.02 || state.stopped || state.since_script_s < 0.3) return;
      state.lie = true;
      change(state);
    };
  };
  stops("elbow 5 degrees beside the way there", Halt::OffWay,
        on_the_way([](PlayedState& s) { s.q[2] += 5 * k_deg; }));
  stops("another program on the way there", Halt::OffWay,
        on_the_way([](PlayedState& s) { s.q = {0, -1.57, 0, -1.57, 0, 0}; }));
}

ORDINARY_TIMED_TEST(FollowFaults, AnotherProgramStopsTheArm) {
  double begun_s = -1;
  stops("another program goes its own way", Halt::OffPath, [&](PlayedState& state, double share) {
    if (share < 0.22 || state.stopped) return;
    if (begun_s < 0) begun_s = state.since_script_s;
    const double gone_mm = 100 * (state.since_script_s - begun_s);
    move(state, 0, 0, gone_mm);
    // No farther off the path than it has gone: a host that stops the arm has seen such a state.
    state.lie = gone_mm > limits.off_path_mm;
  });
}

ORDINARY_TIMED_TEST(FollowFaults, OtherToolStopsTheArm) {
  stops("controller reckons with another tip", Halt::OtherTool,
        from(0.22, [](PlayedState& s) { s.tcp_offset[2] += 0.05; }));
}

ORDINARY_TIMED_TEST(FollowFaults, StatesWithoutNumbersStopTheArm) {
  stops("tip NaN", Halt::Unusable, from(0.22, [](PlayedState& s) { s.tcp_pose.fill(k_nan); }));
  stops("one joint NaN", Halt::Unusable, from(0.22, [](PlayedState& s) { s.q[5] = k_nan; }));
  stops("tool NaN", Halt::Unusable, from(0.22, [](PlayedState& s) { s.tcp_offset[0] = k_nan; }));
  stops("clock 1e300", Halt::Unusable, from(0.22, [](PlayedState& s) { s.time_s = 1e300; }));
  stops("tip infinite on the way there", Halt::Unusable, [](PlayedState& state, double share) {
    if (share > -0.02 || state.stopped || state.since_script_s < 0.3) return;
    state.lie = true;
    state.tcp_pose[1] = std::numeric_limits<double>::infinity();
  });
}

ORDINARY_TIMED_TEST(FollowFaults, FrozenControllerStopsTheArm) {
  stops("sends nothing", Halt::Silent, from(0.22, [](PlayedState& s) { s.send = false; }), limits.silence_s);
  // The tip stands in what it sends, too: where a late machine lets states pile up, a tip that went on would
  // be as rightly told as off the path.
  std::optional<PlayedState> frozen;
  stops(
      "sends the same instant for ever", Halt::Silent,
      [&frozen](PlayedState& state, double share) {
        if (share < 0.22 || state.stopped) return;
        if (!frozen) frozen = state;
        state.lie = true;
        state.time_s = frozen->time_s;
        state.q = frozen->q;
        state.tcp_pose = frozen->tcp_pose;
      },
      limits.silence_s);
  double backwards_s = -1;
  stops(
      "clock runs backwards", Halt::Silent,
      [&backwards_s](PlayedState& state, double share) {
        if (share < 0.22 || state.stopped) return;
        if (backwards_s < 0) backwards_s = state.time_s;
        state.lie = true;
        state.time_s = 2 * backwards_s - state.time_s;
      },
      limits.silence_s);
}

ORDINARY_TIMED_TEST(FollowFaults, TipThatStandsWhileTheProgramRunsStopsTheArm) {
  const test::PlayedPath played{path.path(), home_rad};
  stops(
      "tip stands on the shoe", Halt::Stalled,
      [&](PlayedState& state, double share) {
        if (share < 0.22 || state.stopped) return;
        state.lie = true;
        played.fill(played.way_s() + 0.22 * (played.duration_s() - played.way_s()), state);
      },
      limits.stall_s);
}

ORDINARY_TIMED_TEST(FollowFaults, FarTooSlowOrTooFastStopsTheArm) {
  limits.late_s = 0.5;
  const auto whole = [](PlayedState& state, double share) {
    if (share > 0 && !state.stopped) state.lie = true;
  };
  stops("at a third of the speed, slider at 1", Halt::Late, whole, 20, 0.33);
  const auto says_slow = [](double PlayedState::*told) {
    return [told](PlayedState& state, double share) {
      if (share <= 0 || state.stopped) return;
      state.lie = true;
      state.*told = 0.1;
    };
  };
  stops("at full speed, slider at 0.1", Halt::Late, says_slow(&PlayedState::speed_slider), 20);
  stops("at full speed, limits leave 0.1", Halt::Late, says_slow(&PlayedState::speed_scaling), 20);
}

TEST(FollowFaults, SliderAndLimitsAreOneSpeed) {
  const auto tells = [](PlayedState& state, double) {
    state.speed_scaling = 0.5;
    state.speed_slider = 0.6;
  };
  const Played played = play(tells, 0.3);
  CHECK_TEXT(played.followed.has_value(), played.followed ? "" : to_line(played.followed.error()).c_str());
  DOUBLES_EQUAL(0.3, played.report.slowest_speed_ratio, 1e-12);
}

ORDINARY_TIMED_TEST(FollowFaults, SafetyAndPowerStopTheArm) {
  stops("protective stop", Halt::ProtectiveStop, from(0.22, [](PlayedState& s) { s.safety_mode = 3; }));
  stops("emergency stop", Halt::ProtectiveStop, from(0.22, [](PlayedState& s) { s.safety_mode = 7; }));
  stops("fault", Halt::ProtectiveStop, from(0.22, [](PlayedState& s) { s.safety_mode = 9; }));
  stops("power off", Halt::PowerOff, from(0.22, [](PlayedState& s) { s.robot_mode = 3; }));
  stops("brakes", Halt::PowerOff, from(0.22, [](PlayedState& s) { s.robot_mode = 5; }));
  stops("backdrive: hands on the arm", Halt::PowerOff, from(0.22, [](PlayedState& s) { s.robot_mode = 6; }));
}

ORDINARY_TIMED_TEST(FollowFaults, LocalControlStopsTheArm) {
  has_status_3(stops("somebody sets local control", Halt::LocalControl,
                     from(0.22, [](PlayedState& s) { s.remote = false; }), 0.5));
  stops("from the beginning on", Halt::LocalControl, from(-10, [](PlayedState& s) { s.remote = false; }),
        0.5);
}

ORDINARY_TIMED_TEST(FollowFaults, StopFromOutsideStopsTheArm) {
  stops("the service is told to stop", Halt::Person, from(0.22, [this](PlayedState&) { said.stop(); }));
}

TEST(FollowFaults, ProgramThatEndsEarlyOrLeavesPartsOutIsNotDone) {
  const Played half = play([](PlayedState& state, double share) {
    if (share > 0.5) state.runtime_state = 1;
  });
  CHECK(!half.followed.has_value());
  CHECK(half.report.halt->code == Halt::NotCovered);
  CHECK(half.times.stop && half.times.output_off);
  CHECK(half.report.ending.at_rest);
  has_status_3(half);
  CHECK(half.report.deviation.covered < 0.7);

  const Played at_once = play([](PlayedState& state, double) {
    if (state.since_script_s > 0.3) state.runtime_state = 1;
  });
  CHECK(!at_once.followed.has_value());
  CHECK(at_once.report.halt->code == Halt::NotCovered);
}

ORDINARY_TIMED_TEST(FollowFaults, ProgramThatDoesNotStartIsToldAndStopped) {
  stops(
      "program never starts", Halt::NotStarted,
      [](PlayedState& state, double) {
        state.runtime_state = 1;
        state.lie = true;
      },
      6);
}

/// The controller says why, and nobody waits for the program's beginning.
ORDINARY_TIMED_TEST(FollowFaults, ProgramThatTheControllerDoesNotTakeIsToldInItsWords) {
  test::FakeController* there = nullptr;
  prepare = [&](test::FakeController& controller) { there = &controller; };
  bool said_it = false;
  const Played out = stops("program not taken", Halt::ProgramError, [&](PlayedState& state, double) {
    state.runtime_state = 1;
    state.lie = true;
    if (!std::exchange(said_it, true))
      there->say_on_script(test::runtime_exception(12, 3, "compile_error_name_not_found:movep:"));
  });
  STRCMP_CONTAINS("line 12, column 3: compile_error_name_not_found:movep:", out.report.halt->reason.c_str());
}

ORDINARY_TIMED_TEST(FollowFaults, ProgramThatFailsWhileItRunsStopsTheArm) {
  test::FakeController* there = nullptr;
  prepare = [&](test::FakeController& controller) { there = &controller; };
  bool said_it = false;
  stops(
      "program fails", Halt::ProgramError, from(0.3, [&](PlayedState&) {
        if (!std::exchange(said_it, true))
          there->say_on_script(test::joined({test::key_message("PROGRAM_XXX_STARTED", "other"),
                                             test::runtime_exception(40, 1, "no inverse kinematics found")}));
      }));
}

}  // namespace biteline::robot
