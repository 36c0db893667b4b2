// SPDX-License-Identifier: MIT
// How runs end: what says "it has ended" may be wrong, a word that stops the arm may be lost, the tool may
// stay on. Each is a row of tests/integration/faults/ROBOT.md.
#include <CppUTest/TestHarness.h>

#include <cstdio>
#include <optional>
#include <thread>
#include <utility>

#include "tests/integration/robot/played_run.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline::robot {
namespace {

using test::FakeController;
using test::Played;
using test::PlayedState;
using test::seconds_between;

constexpr double k_somewhere = 0.22;  // of the path: on the line

}  // namespace

TEST_GROUP_BASE(FollowEndings,
                test::PlayedRun){/// The service is told to stop on the line.
                                 test::Lie told_to_stop(){return [this](PlayedState& state, double share) {
                                   if (share < k_somewhere || state.stopped) return;
                                   state.lie = true;
                                   said.stop();
                                 };
}  // namespace biteline::robot
static void is_stopped(const Played& out, Halt expected) {
  CHECK(!out.followed.has_value());
  CHECK(out.report.halt.has_value());
  STRCMP_EQUAL(report::refusal_row(expected).name, report::refusal_row(out.report.halt->code).name);
  std::printf("%s\n", to_line(out.followed.error()).c_str());
  CHECK(out.times.stop_words > 0);
  CHECK(out.times.output_off.has_value());
  CHECK(out.report.ending.at_rest);
  CHECK(out.times.rest.has_value());
  CHECK(out.returned >= *out.times.rest);
}
static void is_done(const Played& out) {
  CHECK_TEXT(out.followed.has_value(), out.followed ? "" : to_line(out.followed.error()).c_str());
  CHECK(out.report.ending.at_rest);
  CHECK(out.report.ending.tool == ToolOutput::Off);
  LONGS_EQUAL(0, out.times.stop_words);
}
}
;

TEST(FollowEndings, FewStatesThatSayTheProgramEndedAreNotBelieved) {
  int lies = 0;
  is_done(play([&](PlayedState& state, double share) {
    if (share > k_somewhere && ++lies <= 15) state.runtime_state = 1;  // some 30 ms
  }));
  CHECK(lies > 15);
}

TEST(FollowEndings, RuntimeStateThatFlickersAllTheWayIsNotBelieved) {
  int count = 0;
  is_done(play([&](PlayedState& state, double share) {
    if (share > 0 && share < 0.99 && ++count % 3 != 0) state.runtime_state = 1;
  }));
}

TEST(FollowEndings, ProgramThatIsSaidToHaveEndedIsStoppedAndSeenAtRest) {
  for (const double begin : {-0.02, 0.05, k_somewhere, 0.9}) {
    const Played out = play([&](PlayedState& state, double share) {
      if (share > begin && state.since_script_s > 0.3) state.runtime_state = 1;
    });
    is_stopped(out, Halt::NotCovered);
  }
}

ORDINARY_TIMED_TEST(FollowEndings, LineThatTheJudgeFindsLeftOutStopsTheArm) {
  // The arm comes to the path's end as planned, and the tip was 1.9 mm beside a part of it: within the limit,
  // so that only the judge's coverage speaks.
  limits.covered = 1.01;
  const Played out = play([](PlayedState&, double) {});
  is_stopped(out, Halt::NotCovered);
}

ORDINARY_TIMED_TEST(FollowEndings, MuteDashboardDelaysNeitherWord) {
  prepare = [](FakeController& controller) { controller.mute_dashboard = true; };
  const Played out = play(told_to_stop());
  is_stopped(out, Halt::Person);
  CHECK(seconds_between(*out.times.lie, *out.times.stop) < 0.1);
  CHECK(seconds_between(*out.times.lie, *out.times.output_off) < 0.1);
}

ORDINARY_TIMED_TEST(FollowEndings, DashboardThatHearsNothingDoesNotDelayTheStopProgram) {
  FakeController* there = nullptr;
  prepare = [&](FakeController& controller) { there = &controller; };
  const Played out = play([&, told = told_to_stop()](PlayedState& state, double share) {
    if (share > k_somewhere) there->refuse_dashboard = true;
    told(state, share);
  });
  CHECK(out.report.halt && out.report.halt->code == Halt::Person);
  CHECK(out.times.output_off.has_value());
  CHECK(seconds_between(*out.times.lie, *out.times.output_off) < 0.1);
  CHECK(out.report.ending.at_rest);
}

ORDINARY_TIMED_TEST(FollowEndings, StopProgramTakesAFreshConnectionWhereTheKeptOneIsClosed) {
  FakeController* there = nullptr;
  prepare = [&](FakeController& controller) { there = &controller; };
  bool closed = false;
  const Played out = play([&, told = told_to_stop()](PlayedState& state, double share) {
    if (share > 0.1 && !std::exchange(closed, true)) there->close_script = true;
    told(state, share);
  });
  is_stopped(out, Halt::Person);
  CHECK(seconds_between(*out.times.lie, *out.times.output_off) < 0.1);
}

ORDINARY_TIMED_TEST(FollowEndings, StopProgramArrivesWhereTheConnectionIsClosedAtThatMoment) {
  FakeController* there = nullptr;
  prepare = [&](FakeController& controller) { there = &controller; };
  bool closed = false;
  const Played out = play([&, told = told_to_stop()](PlayedState& state, double share) {
    if (share >= k_somewhere && !std::exchange(closed, true)) there->close_script = true;
    told(state, share);
  });
  is_stopped(out, Halt::Person);
}

ORDINARY_TIMED_TEST(FollowEndings, ScriptConnectionThatTheControllerClosesIsMadeAnew) {
  FakeController* there = nullptr;
  prepare = [&](FakeController& controller) { there = &controller; };
  bool closed = false;
  const Played out = play([&](PlayedState&, double share) {
    if (share > 0.1 && !std::exchange(closed, true)) there->close_script = true;
  });
  is_done(out);
  LONGS_EQUAL(2, out.script_connections);
}

/// Nothing could switch the tool off: the arm is stopped by the dashboard's word, and the tool is told.
ORDINARY_TIMED_TEST(FollowEndings, ScriptPortThatStaysClosedStopsTheArm) {
  FakeController* there = nullptr;
  prepare = [&](FakeController& controller) { there = &controller; };
  const Played out = play([&](PlayedState& state, double share) {
    if (share > 0.1) there->shut_script = true;
    if (share > 0.1) state.outputs = 1;
  });
  CHECK(out.report.halt.has_value());
  STRCMP_EQUAL("stop_door_closed", report::refusal_row(out.report.halt->code).name);
  CHECK(out.times.stop_words > 0);
  CHECK(out.report.ending.at_rest);
  CHECK(out.report.ending.tool == ToolOutput::On);
  CHECK(out.report.halt->reason.starts_with("THE TOOL IS STILL ON: "));
}

TEST(FollowEndings, StatesOnTheScriptPortAreReadAway) {
  FakeController* there = nullptr;
  prepare = [&](FakeController& controller) {
    there = &controller;
    controller.stream_script = true;
  };
  const Played out = play(told_to_stop());
  is_stopped(out, Halt::Person);
  LONGS_EQUAL(1, out.script_connections);
}

ORDINARY_TIMED_TEST(FollowEndings, ToolThatStaysOnAfterAStopIsSentOffAgainAndTold) {
  const Played out = play([told = told_to_stop()](PlayedState& state, double share) {
    if (share > 0.1) state.outputs = 1;
    told(state, share);
  });
  is_stopped(out, Halt::Person);
  CHECK(out.report.ending.tool == ToolOutput::On);
  LONGS_EQUAL(2, out.times.stop_programs);
  CHECK(out.report.halt->reason.starts_with("THE TOOL IS STILL ON: "));
  CHECK(to_line(out.followed.error()).find("THE TOOL IS STILL ON: ") != std::string::npos);
}

ORDINARY_TIMED_TEST(FollowEndings, ToolThatObeysTheSecondWordIsOff) {
  const Played out = play([told = told_to_stop()](PlayedState& state, double share) {
    if (share > 0.1 && state.stop_programs < 2) state.outputs = 1;
    told(state, share);
  });
  is_stopped(out, Halt::Person);
  CHECK(out.report.ending.tool == ToolOutput::Off);
  LONGS_EQUAL(2, out.report.ending.stops);
  CHECK(out.report.halt->reason.find("STILL ON") == std::string::npos);
}

ORDINARY_TIMED_TEST(FollowEndings, ToolThatStaysOnAfterAWholeRunIsNoDoneJob) {
  const Played out = play([](PlayedState& state, double share) {
    if (share > 0) state.outputs = 0x81;
  });
  is_stopped(out, Halt::ToolOn);
  CHECK(out.report.ending.tool == ToolOutput::On);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Connection),
              static_cast<int>(error_row(out.followed.error().code).exit_status));
}

ORDINARY_TIMED_TEST(FollowEndings, OutputBitThatFlapsIsNotSeenOff) {
  int count = 0;
  const Played out = play([&](PlayedState& state, double share) {
    if (share > 0) state.outputs = ++count % 2 == 0 ? 1 : 0;
  });
  CHECK(out.report.halt && out.report.halt->code == Halt::ToolOn);
  CHECK(out.report.ending.tool == ToolOutput::On);
}

TEST(FollowEndings, OtherOutputsAreNoneOfItsBusiness) {
  is_done(play([](PlayedState& state, double) { state.outputs = 0xFE; }));
}

ORDINARY_TIMED_TEST(FollowEndings, ArmThatMovesOnIsNotAtRestWhateverItsProgramStateSays) {
  double slide_m = 0;
  const Played out = play([&](PlayedState& state, double share) {
    if (share < k_somewhere) return;
    state.runtime_state = 1;
    if (state.stopped) state.tcp_pose[0] += slide_m += 1e-4;
  });
  CHECK(out.report.halt && out.report.halt->code == Halt::NotCovered);
  CHECK(!out.report.ending.at_rest);
  LONGS_EQUAL(2, out.report.ending.stops);
  CHECK(out.report.halt->reason.find("EMERGENCY STOP") != std::string::npos);
}

TEST(FollowEndings, OneNoToRemoteControlIsAskedAgainAndTwoAreBelieved) {
  prepare = [](FakeController& controller) { controller.noes = 1; };
  is_done(play([](PlayedState&, double) {}));
  prepare = [](FakeController& controller) { controller.noes = 2; };
  is_stopped(play([](PlayedState&, double) {}), Halt::LocalControl);
}

/// From before the program, where none runs and the arm stands elsewhere.
TEST(FollowEndings, OldStatesAmongTheNewOnesAreNotLookedAt) {
  std::optional<PlayedState> old;
  int count = 0;
  is_done(play([&](PlayedState& state, double share) {
    if (!old) old = state;
    if (share < 0 || ++count % 3 != 0) return;
    state.time_s = old->time_s - 0.008 * (count % 5);
    state.q = old->q;
    state.tcp_pose = old->tcp_pose;
    state.runtime_state = 1;
    state.outputs = 1;
  }));
  CHECK(count > 100);
}

/// A connection that breaks while the program is sent: nobody knows what the controller has of it.
TEST(FollowEndings, ProgramThatDoesNotLeaveWholeIsStopped) {
  struct Broken final : RobotLink {
    kinematics::Joints q_rad;
    bool begun{true};
    int stops{0};
    mutable std::uint64_t sequence{0};
    RobotState state() const {
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
      const auto now = std::chrono::steady_clock::now().time_since_epoch();
      RobotState state;
      state.sequence = ++sequence;
      state.sampled = RobotClock::time_point{std::chrono::duration_cast<Nanoseconds>(now)};
      state.received = HostClock::time_point{std::chrono::duration_cast<Nanoseconds>(now)};
      state.q_rad = q_rad;
      state.powered = true;
      state.program_running = stops == 0;
      state.safety = Safety::Normal;
      return state;
    }
    Result<RobotState> latest() const override { return state(); }
    Result<RobotState> wait_newer(std::uint64_t, Nanoseconds) const override { return state(); }
    Result<void> send(const PermittedPath&) override { return fail(Errc::ConnectionLost, "script: sending"); }
    bool may_run() const override { return begun; }
    [[nodiscard]] bool has_dead_man() const override { return false; }
    Result<void> stop() override {
      ++stops;
      return {};
    }
    void beat() override {}
    std::optional<bool> remote_control() override { return {}; }
    void start_recording() override {}
    std::vector<RobotState> take_recording() override { return {state(), state()}; }
    LinkStatus status() const override { return {}; }
  } link;
  link.q_rad = home_rad;
  FollowReport report;
  const auto followed = follow(link, test::permitted(path, home_rad), {}, report);
  CHECK(!followed.has_value());
  CHECK(report.halt && report.halt->code == Halt::NotSent);
  LONGS_EQUAL(1, link.stops);
  CHECK(report.ending.at_rest);
  // What never left needs no stop: somebody else's program may run there.
  link.begun = false;
  link.stops = 0;
  FollowReport refused;
  CHECK(!follow(link, test::permitted(path, home_rad), {}, refused).has_value());
  LONGS_EQUAL(0, link.stops);
}

}  // namespace biteline::robot
