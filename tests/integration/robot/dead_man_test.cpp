// SPDX-License-Identifier: MIT
// An arm whose run nobody watches any more: the program on the controller ends itself, its tool off.
#include <CppUTest/TestHarness.h>
#include <spawn.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "hal/sim/live/urgency.hpp"
#include "host/robot/link/follow.hpp"
#include "host/robot/link/ur/arm_claim.hpp"
#include "host/robot/link/ur/pendant_watch.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/link/ur/ur_link.hpp"
#include "tests/integration/robot/short_path.hpp"
#include "tests/soak/controller_between.hpp"
#include "tests/support/timed_test.hpp"
#include "tests/unit/host/robot/link/permitted.hpp"

namespace biteline::robot {
namespace {

using soak::ControllerBetween;
using soak::Lie;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

// Beyond the dead man's own time: a beat on its way, a thread that dies, a look of this test.
constexpr double k_slack_s = 0.08;
constexpr int k_trials = 4;

enum class End { Killed, Frozen, Unplugged, NoMemory };
const char* name_of(End end) {
  switch (end) {
    case End::Killed:
      return "SIGKILL";
    case End::Frozen:
      return "SIGSTOP";
    case End::Unplugged:
      return "cable out";
    case End::NoMemory:
      return "out of memory";
  }
  return "";
}

SE3 T_base_flange_home(const sim::ArmKinematics& arm) {
  sim::JointVector q_rad;
  q_rad << 0.0, -1.8, 1.6, -1.4, -1.57, 0.0;
  return arm.T_base_flange(q_rad);
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The service of one trial.
class Follower {
 public:
  explicit Follower(const ControllerBetween& controller) {
    std::vector<std::string> words{BITELINE_FOLLOWER, std::to_string(controller.rtde_port()),
                                   std::to_string(controller.script_port()),
                                   std::to_string(controller.dashboard_port())};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    CHECK_EQUAL(0, posix_spawn(&pid_, BITELINE_FOLLOWER, nullptr, nullptr, arguments.data(), environ));
  }
  ~Follower() {
    signal(SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;
  void signal(int number) const { kill(pid_, number); }

 private:
  pid_t pid_{-1};
};

}  // namespace

TEST_GROUP(DeadMan) {
  sim::ArmKinematics kinematics = *sim::ArmKinematics::named("ur5e");
  sim::Arm arm{kinematics, T_base_flange_home(kinematics)};
  std::unique_ptr<sim::UrController> controller;
  std::unique_ptr<ControllerBetween> between;
  Stops said;

  void setup() override {
    // Its threads begin with the rights of the one that makes them.
    const sim::Urgently urgently{sim::k_robot_priority};
    controller = *sim::UrController::open({}, arm, {});
    between = *ControllerBetween::open(controller->ports());
  }
  void teardown() override {
    between.reset();
    controller.reset();
  }

  sim::ArmState now() const {
    return arm.at(hal::monotonic_now());
  }
  bool tool_on() const {
    return (now().outputs & 1U) != 0;
  }
  bool is_safe() const {
    return !now().program_running && !tool_on();
  }
  template <class Holds>
  static bool comes(double patience_s, Holds holds) {
    for (const auto begin = Clock::now(); seconds_since(begin) < patience_s;
         std::this_thread::sleep_for(milliseconds{1})) {
      if (holds()) return true;
    }
    return false;
  }
  std::unique_ptr<ur::ArmClaim> claim() const {
    auto taken = ur::ArmClaim::take({.rtde_port = between->rtde_port(), .patience_s = 20});
    CHECK(taken.has_value());
    CHECK((*taken)->state() == ur::ArmClaim::State::Held);
    return std::move(*taken);
  }
  std::unique_ptr<ur::UrLink> link(ur::ArmClaim * claim) const {
    auto opened = ur::UrLink::open({.rtde_port = between->rtde_port(),
                                    .script_port = between->script_port(),
                                    .dashboard_port = between->dashboard_port(),
                                    .connect_patience_s = 20,
                                    .claim = claim});
    CHECK_TEXT(opened.has_value(), opened ? "" : to_line(opened.error()).c_str());
    return std::move(*opened);
  }
  PermittedPath from_here(const ur::UrLink& link) const {
    const auto still = wait_until_still(link, {.turn_rad = k_ringing_rad, .move_mm = k_ringing_mm});
    CHECK(still.has_value());
    return test::permitted(test::short_path(), still->q_rad, said.now());
  }

  /// One service, ended one way at a random moment. Seconds until arm and tool were safe.
  double end_at_random(End end, double most_s, std::mt19937& random, int number) {
    const Follower follower{*between};
    CHECK(comes(120, [&] { return now().program_running && now().program_name == ur::k_program_name; }));
    const double duration_s = arm.running(hal::monotonic_now()).program->duration_s();
    std::uniform_real_distribution<double> moments{0.0, std::min(most_s, duration_s - 1)};
    const double moment_s = moments(random);
    std::this_thread::sleep_for(std::chrono::duration<double>(moment_s));
    CHECK(now().program_running);
    const bool was_on = tool_on();
    const auto begin = Clock::now();
    const SE3 T_begin = now().T_base_flange;
    if (end == End::Killed) follower.signal(SIGKILL);
    if (end == End::Frozen) follower.signal(SIGSTOP);
    if (end == End::NoMemory) follower.signal(SIGUSR1);
    if (end == End::Unplugged) between->lie = Lie::Unplugged;
    CHECK_TEXT(comes(10, [&] { return is_safe(); }), name_of(end));
    const double safe_s = seconds_since(begin);
    const double gone_mm = (now().T_base_flange.translation() - T_begin.translation()).norm();
    std::printf("| %d | %s | %.2f | %s | %.0f | %.1f |\n", number, name_of(end), moment_s,
                was_on ? "on" : "off", 1000 * safe_s, gone_mm);
    std::this_thread::sleep_for(milliseconds{200});
    CHECK_TEXT(is_safe(), name_of(end));
    between->lie = Lie::None;
    return safe_s;
  }
};

/// 50 of them with BITELINE_TRIALS=50, over the whole path: the test `dead_man_long`.
ORDINARY_TIMED_TEST(DeadMan, HoweverTheServiceEndsArmAndToolAreSafeWithinItsTime) {
  const char* const asked = std::getenv("BITELINE_TRIALS");
  const int trials = asked != nullptr ? std::atoi(asked) : k_trials;
  std::mt19937 random{std::random_device{}()};
  double longest_s = 0;
  std::printf("| trial | end | s after its begin | tool | safe after, ms | flange went, mm |\n");
  std::printf("| --- | --- | --- | --- | --- | --- |\n");
  for (int i = 0; i < trials; ++i)
    longest_s = std::max(longest_s,
                         end_at_random(static_cast<End>(i % 4), asked != nullptr ? 1e9 : 6, random, i + 1));
  std::printf("the longest of %d: %.0f ms\n", trials, 1000 * longest_s);
  CHECK(longest_s <= ur::k_dead_man_s + k_slack_s);
  CHECK(controller->programs_cut() == static_cast<std::uint64_t>(trials));
}

/// The count comes from the loop that watches, not from the thread that writes it.
ORDINARY_TIMED_TEST(DeadMan, WatchThatHangsEndsTheProgram) {
  const auto held = claim();
  const auto robot = link(held.get());
  CHECK(robot->send(from_here(*robot)).has_value());
  CHECK(robot->has_dead_man());
  for (const auto begin = Clock::now(); seconds_since(begin) < 2;
       std::this_thread::sleep_for(milliseconds{20}))
    robot->beat();
  CHECK(now().program_running);
  const auto begin = Clock::now();
  CHECK(comes(10, [&] { return is_safe(); }));
  CHECK(seconds_since(begin) <= ur::k_dead_man_s + k_slack_s);
  CHECK(seconds_since(begin) >= 0.3);
}

ORDINARY_TIMED_TEST(DeadMan, StopThatNobodyHearsIsCarriedOutByTheDeadMan) {
  const auto held = claim();
  const auto robot = link(held.get());
  const PermittedPath permitted = from_here(*robot);
  Clock::time_point told;
  std::thread person{[&] {
    static_cast<void>(comes(60, [&] { return tool_on(); }));
    between->lie = Lie::DeafDoors;
    told = Clock::now();
    said.stop();
  }};
  FollowReport report;
  const auto followed = follow(*robot, permitted, {}, report);
  person.join();
  CHECK(!followed.has_value());
  CHECK(report.halt->code == Halt::Person);
  CHECK(is_safe());
  CHECK(report.ending.at_rest);
  CHECK(report.ending.tool == ToolOutput::Off);
  LONGS_EQUAL(1, controller->programs_cut());
}

ORDINARY_TIMED_TEST(DeadMan, SaidToHaveEndedTheProgramIsTrulyStopped) {
  const auto held = claim();
  const auto robot = link(held.get());
  const PermittedPath permitted = from_here(*robot);
  std::thread liar{[&] {
    static_cast<void>(comes(60, [&] { return tool_on(); }));
    between->lie = Lie::SaysEnded;
  }};
  FollowReport report;
  const auto followed = follow(*robot, permitted, {}, report);
  liar.join();
  CHECK(!followed.has_value());
  CHECK(report.halt->code == Halt::NotCovered);
  CHECK(is_safe());
  CHECK(report.ending.at_rest);
  CHECK(between->stops() > 0);
}

/// No gap in them is ever long enough to be silence.
ORDINARY_TIMED_TEST(DeadMan, StatesThatComeLaterAndLaterStopTheArm) {
  const auto held = claim();
  const auto robot = link(held.get());
  const PermittedPath permitted = from_here(*robot);
  Clock::time_point begun;
  std::thread relay{[&] {
    static_cast<void>(comes(60, [&] { return tool_on(); }));
    begun = Clock::now();
    between->lie = Lie::Lagging;
  }};
  FollowReport report;
  const auto followed = follow(*robot, permitted, {}, report);
  const double stopped_s = seconds_since(begun);
  relay.join();
  CHECK(!followed.has_value());
  STRCMP_EQUAL(report::refusal_row(Halt::Old).name, report::refusal_row(report.halt->code).name);
  std::printf("%s, %.2f s after the lag began\n", to_line(followed.error()).c_str(), stopped_s);
  CHECK(stopped_s < 2);  // 0.1 s of lag are there after 0.83 s
  CHECK(is_safe());
}

/// Following and between two paths alike: what was ordered before is over.
ORDINARY_TIMED_TEST(DeadMan, LocalControlAtThePendantIsAStop) {
  std::atomic<int> taken{0};
  ur::PendantWatch pendant{
      {.doors = {.dashboard = {"127.0.0.1", between->dashboard_port()}}, .period = milliseconds{20}}, [&] {
        said.stop();
        ++taken;
      }};
  const auto held = claim();
  const auto robot = link(held.get());
  const PermittedPath permitted = from_here(*robot);
  std::thread person{[&] {
    static_cast<void>(comes(60, [&] { return tool_on(); }));
    controller->set_remote_control(false);
  }};
  FollowReport report;
  {
    const ur::PendantWatch::Rest rest{&pendant};
    const auto followed = follow(*robot, permitted, {.taken = [&] { pendant.tell_taken(); }}, report);
    CHECK(!followed.has_value());
  }
  person.join();
  STRCMP_EQUAL("local_control", report::refusal_row(report.halt->code).name);
  LONGS_EQUAL(1, taken);
  CHECK(permitted.mark().stopped());
  // In local control no stop program is taken: the path's own dead man has switched the tool off.
  CHECK(is_safe());
  CHECK(report.ending.at_rest);
  CHECK(report.ending.tool == ToolOutput::Off);
  // The same deed is no second one, giving the arm back is none, and taking it from an arm that rests is.
  std::this_thread::sleep_for(milliseconds{500});
  controller->set_remote_control(true);
  std::this_thread::sleep_for(milliseconds{500});
  LONGS_EQUAL(1, taken);
  const StopMark mark = said.now();
  controller->set_remote_control(false);
  CHECK(comes(20, [&] { return mark.stopped(); }));
  LONGS_EQUAL(2, taken);
  FollowReport none;
  CHECK(
      !follow(*robot, test::permitted(permitted.path(), robot->latest()->q_rad, mark), {}, none).has_value());
  CHECK_FALSE(none.sent);
}

TEST(DeadMan, WholeRunIsDoneAndSeenAtRest) {
  const auto held = claim();
  const auto robot = link(held.get());
  FollowReport report;
  const auto followed = follow(*robot, from_here(*robot), {}, report);
  CHECK_TEXT(followed.has_value(), followed ? "" : to_line(followed.error()).c_str());
  CHECK(report.ending.at_rest);
  CHECK(report.ending.tool == ToolOutput::Off);
  LONGS_EQUAL(0, report.ending.stops);
  LONGS_EQUAL(0, controller->programs_cut());
}

}  // namespace biteline::robot
