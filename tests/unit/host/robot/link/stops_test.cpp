// SPDX-License-Identifier: MIT
#include "host/robot/link/gate/stops.hpp"

#include <CppUTest/TestHarness.h>

#include <csignal>
#include <thread>
#include <vector>

#include "host/robot/link/follow.hpp"
#include "tests/support/errors.hpp"
#include "tests/unit/host/robot/link/permitted.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot {
namespace {

Stops g_stops;

/// An arm that takes a path and never begins; stops are said where a test wants them.
struct RecordingLink final : RobotLink {
  Stops* stops{nullptr};
  bool stop_before_send{false}, stop_after_send{false};
  int scripts{0}, stopped{0};

  RobotState state() const {
    RobotState state;
    state.sequence = ++sequence_;
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    state.received = HostClock::time_point{std::chrono::duration_cast<Nanoseconds>(now)};
    state.sampled = RobotClock::time_point{state.received.time_since_epoch()};
    state.powered = true;
    state.safety = Safety::Normal;
    state.program_running = scripts > stopped;
    return state;
  }
  Result<RobotState> latest() const override { return state(); }
  Result<RobotState> wait_newer(std::uint64_t, Nanoseconds) const override {
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
    return state();
  }
  Result<void> send(const PermittedPath& path) override {
    if (stop_before_send) stops->stop();
    if (path.mark().stopped()) return fail(Errc::Refused, "stopped before the path was sent");
    ++scripts;
    if (stop_after_send) stops->stop();
    return {};
  }
  [[nodiscard]] bool has_dead_man() const override { return false; }
  Result<void> stop() override {
    stopped = scripts;
    return {};
  }
  bool may_run() const override { return scripts > 0; }
  void beat() override {}
  std::optional<bool> remote_control() override { return true; }
  void start_recording() override {}
  std::vector<RobotState> take_recording() override { return {state()}; }
  LinkStatus status() const override { return {}; }

 private:
  mutable std::uint64_t sequence_{0};
};

}  // namespace

TEST_GROUP(Stops) {
  Stops sut;
  RecordingLink link;
  void setup() override {
    link.stops = &sut;
  }
  Result<void> follow_marked(const StopMark& mark, FollowReport& report) {
    return follow(link, test::permitted(test::planned_path("grind.yaml"), kinematics::Joints::Zero(), mark),
                  {}, report);
  }
};

TEST(Stops, AMarkHoldsUntilTheNextStopAndNeverAgain) {
  const StopMark before = sut.now();
  CHECK_FALSE(before.stopped());
  sut.stop();
  CHECK(before.stopped());
  const StopMark after = sut.now();
  CHECK_FALSE(after.stopped());
  for (int i = 0; i < 3; ++i) sut.stop();
  CHECK(before.stopped() && after.stopped());
  // Of an order that waited: as it was heard.
  CHECK(sut.at(1).stopped());
  CHECK_FALSE(sut.at(sut.count()).stopped());
  // What nobody ordered is nobody's to do.
  CHECK(StopMark{}.stopped());
}

TEST(Stops, AStopOfASignalHandlerCounts) {
  const StopMark mark = g_stops.now();
  const auto before = std::signal(SIGUSR1, [](int) { g_stops.stop(); });
  std::raise(SIGUSR1);
  std::signal(SIGUSR1, before);
  CHECK(mark.stopped());
}

TEST(Stops, NoStopOfManyThreadsIsLost) {
  constexpr std::uint64_t k_each = 10'000;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      for (std::uint64_t k = 0; k < k_each; ++k) sut.stop();
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(sut.count() == 4 * k_each);
}

TEST(Stops, NoPathOfAStoppedOrderLeaves) {
  FollowReport report;
  const StopMark mark = sut.now();
  sut.stop();
  FAILS_NAMING(Errc::Refused, "stopped before the path was sent", follow_marked(mark, report));
  // Nor one that is stopped while it is made ready.
  link.stop_before_send = true;
  FAILS_NAMING(Errc::Refused, "stopped before the path was sent", follow_marked(sut.now(), report));
  CHECK_FALSE(report.sent);
  LONGS_EQUAL(0, link.scripts);
}

TEST(Stops, AStopAfterTheSendingStopsTheArm) {
  FollowReport report;
  link.stop_after_send = true;
  FAILS_NAMING(Errc::Refused, "told to stop", follow_marked(sut.now(), report));
  CHECK(report.sent && report.halt && report.halt->code == Halt::Person);
  LONGS_EQUAL(1, link.scripts);
  LONGS_EQUAL(1, link.stopped);
}

TEST(Stops, AnArmThatIsWaitedForIsWaitedForNoLonger) {
  const StopMark mark = sut.now();
  sut.stop();
  FAILS_NAMING(Errc::Refused, "told to stop",
               wait_until_still(link, {.patience_s = 60, .still_s = 60, .mark = mark}));
}

}  // namespace biteline::robot
