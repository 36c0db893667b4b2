// SPDX-License-Identifier: MIT
/// \file A path in the hands of a made controller that speaks the generic protocol: done, stopped, left
/// alone, spoilt, too old.
#include <CppUTest/TestHarness.h>

#include <cstdio>
#include <functional>
#include <thread>

#include "hal/sim/live/urgency.hpp"
#include "hal/sim/robot/path_taker.hpp"
#include "host/robot/link/follow.hpp"
#include "host/robot/link/other/arm_link.hpp"
#include "host/robot/link/other/path_points.hpp"
#include "host/robot/link/ur/script.hpp"
#include "tests/integration/robot/short_path.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/timed_test.hpp"
#include "tests/support/transforms.hpp"
#include "tests/unit/host/robot/link/permitted.hpp"

namespace biteline::robot {
namespace {

using namespace std::chrono_literals;

SE3 T_base_flange_home(const sim::ArmKinematics& arm) {
  return arm.T_base_flange((sim::JointVector() << 0.0, -1.8, 1.6, -1.4, -1.57, 0.0).finished());
}

/// A controller, its arm, and a link to it.
struct MadeCell {
  explicit MadeCell(const sim::PathTaker::Config& config = {}) {
    // Its threads begin with the rights of the one that makes them.
    const sim::Urgently urgently{sim::k_robot_priority};
    controller = *sim::PathTaker::open(config, arm);
  }
  [[nodiscard]] sim::ArmState now() const { return arm.at(hal::monotonic_now()); }
  [[nodiscard]] bool tool_on() const { return (now().outputs & 1U) != 0; }
  [[nodiscard]] std::unique_ptr<other::ArmLink> link() const {
    auto opened = other::ArmLink::open({.port = controller->port(), .connect_patience_s = 20});
    SUCCEEDS(opened);
    return std::move(*opened);
  }

  /// The whole of it; `meanwhile`: once, as soon as the tool is on.
  [[nodiscard]] Result<void> work(
      FollowReport& report, const std::function<void()>& meanwhile = [] {}) {
    const std::unique_ptr<other::ArmLink> arm_link = link();
    const auto still = wait_until_still(*arm_link, {.turn_rad = k_ringing_rad, .move_mm = k_ringing_mm});
    SUCCEEDS(still);
    std::atomic<bool> over{false};
    std::thread other{[&] {
      while (!over && !tool_on()) std::this_thread::sleep_for(2ms);
      if (!over) meanwhile();
    }};
    Result<void> done =
        follow(*arm_link, test::permitted(test::short_path(), still->q_rad, said.now()), {}, report);
    over = true;
    other.join();
    return done;
  }
  /// Stopped in the middle of the line for that reason, at rest, the tool off.
  void stops_for(const char* reason, const std::function<void()>& meanwhile) {
    FollowReport report;
    CHECK(!work(report, meanwhile).has_value());
    CHECK(report.halt.has_value());
    STRCMP_EQUAL(reason, report::refusal_row(report.halt->code).name);
    CHECK(report.ending.at_rest);
    stands_with_its_tool_off();
  }
  void stands_with_its_tool_off() const {
    CHECK_FALSE(now().moving);
    LONGS_EQUAL(0, now().outputs);
  }
  /// Sent and on the line, by a link that nobody watches.
  [[nodiscard]] std::unique_ptr<other::ArmLink> left_on_the_line() const {
    std::unique_ptr<other::ArmLink> arm_link = link();
    const Result<RobotState> state = arm_link->latest();
    SUCCEEDS(state);
    SUCCEEDS(arm_link->send(test::permitted(test::short_path(), state->q_rad, said.now())));
    while (!tool_on()) {
      arm_link->beat();
      std::this_thread::sleep_for(2ms);
    }
    return arm_link;
  }
  void waits_for(arm_link::Fault fault) const {
    const auto patience_ends = hal::monotonic_now() + 5s;
    while (controller->fault() != fault && hal::monotonic_now() < patience_ends)
      std::this_thread::sleep_for(2ms);
    CHECK(controller->fault() == fault);
    stands_with_its_tool_off();
  }

  sim::ArmKinematics kinematics = *sim::ArmKinematics::named("ur5e");
  sim::Arm arm{kinematics, T_base_flange_home(kinematics)};
  std::unique_ptr<sim::PathTaker> controller;
  Stops said;
};

}  // namespace

TEST_GROUP(ArmLink){};

/// What goes to a Universal Robots' arm as a program goes to another make's as points: the same moves, speeds
/// and roundings, the tool on and off at the same places.
TEST(ArmLink, PointsAreTheMovesOfTheProgram) {
  for (const char* process : {"grind.yaml", "spray.yaml"}) {
    const path::CheckedPath& path = test::planned_path(process);
    const other::PathPoints made = other::path_points(path, 3);
    const Result<sim::Script> script = sim::parse_script(ur::urscript(path));
    SUCCEEDS(script);
    std::size_t at = 0;
    bool on = false;
    for (const sim::ScriptStep& step : script->steps) {
      if (const auto* output = std::get_if<sim::DigitalOutStep>(&step)) on = output->active;
      const auto* move = std::get_if<sim::MoveStep>(&step);
      if (move == nullptr) continue;
      CHECK(at < made.points.size());
      const arm_link::PathPoint& point = made.points[at];
      CHECK_EQUAL(at, point.index);
      ++at;
      CHECK_EQUAL(on, point.tool_on);
      CHECK((move->kind == sim::MoveStep::Kind::Joint) == (point.move == arm_link::PathPoint::Move::Joint));
      if (move->q_rad) DOUBLES_EQUAL(0, (*move->q_rad - point.q_rad).norm(), 1e-6);
      if (move->T_base_tcp) TRANSFORMS_EQUAL(*move->T_base_tcp, point.T_base_tcp, 1e-3, 1e-6);
      DOUBLES_EQUAL(move->speed, point.speed, 1e-3);
      DOUBLES_EQUAL(move->blend_mm, point.blend_mm, 0.01);
      DOUBLES_EQUAL(move->acceleration, point.acceleration, 0.1);
    }
    CHECK_EQUAL(made.points.size(), at);
    CHECK_EQUAL(made.points.size(), made.begin.points);
  }
}

ORDINARY_TIMED_TEST(ArmLink, DoesTheWholeJob) {
  MadeCell cell;
  FollowReport report;
  const Result<void> done = cell.work(report);
  SUCCEEDS(done);
  std::printf("tip %.4f mm mean, %.4f mm max beside the path, %.1f s\n", report.deviation.mean_mm,
              report.deviation.max_mm, report.duration_s);
  CHECK(report.deviation.covered > 0.999);
  LONGS_EQUAL(0, report.ending.stops);
  CHECK_EQUAL(1U, cell.controller->paths_run());
  CHECK_EQUAL(0U, cell.controller->messages_refused());
  cell.stands_with_its_tool_off();
}

ORDINARY_TIMED_TEST(ArmLink, AStopInMidPathEndsIt) {
  MadeCell cell;
  cell.stops_for("stopped_by_a_person", [&] { cell.said.stop(); });
}

ORDINARY_TIMED_TEST(ArmLink, ASafetyStopIsToldAndNothingIsSentDuringOne) {
  MadeCell cell;
  FollowReport report;
  CHECK(!cell.work(report, [&] { cell.controller->set_safe(false); }).has_value());
  STRCMP_EQUAL("protective_stop", report::refusal_row(report.halt->code).name);
  cell.stands_with_its_tool_off();
  FollowReport none;
  CHECK(!cell.work(none).has_value());
  CHECK_FALSE(none.sent);
}

/// Somebody moves the arm by hand, or its program does what it was not told: the host stops it.
ORDINARY_TIMED_TEST(ArmLink, AnArmThatLeavesItsPathIsStopped) {
  MadeCell cell;
  cell.stops_for("off_path", [&] {
    sim::Script astray{.name = "astray", .steps = {}};
    sim::MoveStep away;
    away.T_base_tcp = cell.now().T_base_flange * cell.now().T_flange_tcp;
    away.T_base_tcp->translation().z() += 60;
    away.speed = 100;
    away.acceleration = 500;
    astray.steps.emplace_back(away);
    cell.arm.run(astray, hal::monotonic_now());
  });
}

ORDINARY_TIMED_TEST(ArmLink, WhereTheHostIsGoneTheControllerStops) {
  MadeCell cell;
  cell.left_on_the_line().reset();
  cell.waits_for(arm_link::Fault::PeerGone);
}

ORDINARY_TIMED_TEST(ArmLink, WhereNobodyWatchesTheControllerStops) {
  MadeCell cell;
  const std::unique_ptr<other::ArmLink> link = cell.left_on_the_line();
  cell.waits_for(arm_link::Fault::DeadMan);
  STRCMP_CONTAINS("beats ended", link->status().last_text.c_str());
}

ORDINARY_TIMED_TEST(ArmLink, APathThatArrivesOtherwiseMovesNothing) {
  MadeCell cell{{.spoils_paths = true}};
  FollowReport report;
  FAILS_NAMING(Errc::CheckFailed, "did not arrive as it was sent", cell.work(report));
  CHECK_FALSE(report.sent);
  CHECK_EQUAL(0U, cell.controller->paths_run());
}

ORDINARY_TIMED_TEST(ArmLink, APathThatIsTooOldMovesNothing) {
  MadeCell cell{{.path_age_max = -1ns}};
  FollowReport report;
  FAILS_NAMING(Errc::PeerRefused, "the path is too old", cell.work(report));
  CHECK_EQUAL(0U, cell.controller->paths_run());
  cell.stands_with_its_tool_off();
}

ORDINARY_TIMED_TEST(ArmLink, AConnectionThatBreaksComesBack) {
  MadeCell cell;
  const std::unique_ptr<other::ArmLink> link = cell.link();
  STRCMP_EQUAL("made", link->robot()->make.c_str());
  const std::uint16_t port = cell.controller->port();
  cell.controller.reset();
  const auto patience_ends = hal::monotonic_now() + 20s;
  while (link->latest() && hal::monotonic_now() < patience_ends) std::this_thread::sleep_for(2ms);
  CHECK_FALSE(link->stop().has_value());
  CHECK_FALSE(link->robot().has_value());
  cell.controller = *sim::PathTaker::open({.port = port}, cell.arm);
  while (!link->latest() && hal::monotonic_now() < patience_ends) std::this_thread::sleep_for(2ms);
  SUCCEEDS(link->latest());
  CHECK_EQUAL(2U, link->status().connections);
}

TEST(ArmLink, AnArmWithSevenJointsIsRefusedByName) {
  MadeCell cell{{.robot = {.make = "other", .model = "seven", .serial = "", .joints = 7}}};
  FAILS_NAMING(Errc::NotSupported, "other seven: 7 joints, six expected",
               other::ArmLink::open({.port = cell.controller->port(), .connect_patience_s = 20}));
}

/// It is the one host for as long as it lives, and whoever comes later is told so.
TEST(ArmLink, ASecondHostIsToldThatThereIsOne) {
  MadeCell cell;
  std::unique_ptr<other::ArmLink> first = cell.link();
  const other::ArmLink::Config config{.port = cell.controller->port(), .connect_patience_s = 0.5};
  FAILS_NAMING(Errc::PeerRefused, "another host is connected", other::ArmLink::open(config));
  first.reset();
  // Its connection is found closed within this one's patience.
  SUCCEEDS(other::ArmLink::open({.port = cell.controller->port(), .connect_patience_s = 20}));
}

TEST(ArmLink, AControllerThatIsAwayIsCalledOnWhereThatIsWanted) {
  MadeCell cell;
  const std::uint16_t port = cell.controller->port();
  cell.controller.reset();
  FAILS_NAMING(Errc::ConnectFailed, "no state", other::ArmLink::open({.port = port}));
  const auto link = other::ArmLink::open({.port = port, .may_be_away = true});
  SUCCEEDS(link);
  CHECK_FALSE((*link)->latest().has_value());
  cell.controller = *sim::PathTaker::open({.port = port}, cell.arm);
  const auto patience_ends = hal::monotonic_now() + 20s;
  while (!(*link)->latest() && hal::monotonic_now() < patience_ends) std::this_thread::sleep_for(2ms);
  SUCCEEDS((*link)->latest());
}

/// A listener at the wrong port, or a port scanner: the host comes in all the same.
TEST(ArmLink, WhoSaysNothingIsNoHost) {
  MadeCell cell;
  auto silent = ur::TcpStream::connect({"127.0.0.1", cell.controller->port()}, 5s);
  SUCCEEDS(silent);
  const std::unique_ptr<other::ArmLink> link = cell.link();
  SUCCEEDS(link->latest());
}

/// What listeners say is not read: no word at their port does anything, and the host's work goes on.
TEST(ArmLink, AtThePortOfPosesNothingCanBeSaid) {
  using namespace arm_link;
  MadeCell cell;
  auto listener = ur::TcpStream::connect({"127.0.0.1", cell.controller->pose_port()}, 5s);
  SUCCEEDS(listener);
  std::uint32_t number = 0;
  for (const Body& body : {Body{Hello{}}, Body{PathBegin{.path = 1, .points = 1}},
                           Body{PathPoint{.path = 1, .speed = 10, .acceleration = 10}}, Body{PathEnd{1}},
                           Body{Go{.path = 1, .sum = 1}}, Body{Stop{}}})
    SUCCEEDS(listener->write_all(encode(++number, body), 1s));
  Reader reader;
  std::vector<std::uint8_t> bytes;
  int states = 0;
  for (int turn = 0; turn < 1000 && states < 50; ++turn) {
    SUCCEEDS(listener->read_some(bytes, 50ms));
    reader.add(bytes);
    for (auto received = reader.next(); received && *received; received = reader.next()) {
      const auto* state = std::get_if<State>(&(*received)->body);
      CHECK(state != nullptr);
      CHECK(state->phase == Phase::Idle);
      ++states;
    }
  }
  CHECK(states >= 50);
  CHECK_EQUAL(0U, cell.controller->messages_refused());
  static_cast<void>(cell.link());
}

/// Its points carry neither the times of a gun nor an analog output: worked without them it would be another
/// process.
TEST(ArmLink, AProcessWithAFlowIsNotSent) {
  path::PlanRequest request = test::plan_request("spray.yaml");
  request.process.flow = path::Flow{.gun_on_s = 0.04};
  const path::PlanOutcome outcome = path::plan(request);
  CHECK(outcome.path.has_value());
  MadeCell cell;
  const std::unique_ptr<other::ArmLink> link = cell.link();
  const Result<RobotState> state = link->latest();
  SUCCEEDS(state);
  FAILS_NAMING(Errc::NotSupported, "does not carry the process's flow",
               link->send(test::permitted(*outcome.path, state->q_rad, cell.said.now())));
  CHECK_FALSE(link->may_run());
  CHECK_EQUAL(0U, cell.controller->paths_run());
}

/// Word for word, as somebody else's host might say them.
TEST(ArmLink, WordsOutOfPlaceAreRefusedAndASpoiltStreamIsClosed) {
  using namespace arm_link;
  MadeCell cell;
  auto stream = ur::TcpStream::connect({"127.0.0.1", cell.controller->port()}, 5s);
  SUCCEEDS(stream);
  std::uint32_t number = 0;
  Reader reader;
  std::vector<std::uint8_t> bytes;
  /// The controller's next word that is no state.
  const auto answer = [&]() -> Body {
    const auto patience_ends = hal::monotonic_now() + 5s;
    while (hal::monotonic_now() < patience_ends) {
      const auto received = reader.next();
      SUCCEEDS(received);
      if (*received && !std::holds_alternative<State>((*received)->body)) return (*received)->body;
      if (*received) continue;
      SUCCEEDS(stream->read_some(bytes, 50ms));
      reader.add(bytes);
    }
    return Body{};
  };
  const auto refused = [&](const Body& body, Reason reason) {
    SUCCEEDS(stream->write_all(encode(++number, body), 1s));
    const Body said = answer();
    CHECK(std::holds_alternative<Refusal>(said));
    CHECK_TEXT(std::get<Refusal>(said).reason == reason, name_of(std::get<Refusal>(said).reason));
    CHECK_EQUAL(kind_of(body), std::get<Refusal>(said).of);
  };
  refused(PathPoint{.path = 1}, Reason::Order);
  refused(PathEnd{.path = 1}, Reason::Order);
  refused(Go{.path = 1, .sum = 1}, Reason::Order);
  refused(Robot{}, Reason::Order);
  refused(PathBegin{.path = 1, .points = 0}, Reason::Points);
  refused(PathBegin{.path = 1, .points = k_most_points + 1}, Reason::Points);
  const auto begin = [&] {
    SUCCEEDS(stream->write_all(encode(++number, PathBegin{.path = 1, .points = 1}), 1s));
  };
  begin();
  refused(PathPoint{.path = 1, .index = 1}, Reason::Points);
  begin();
  refused(PathPoint{.path = 2, .index = 0}, Reason::WrongPath);
  begin();
  refused(PathEnd{.path = 1}, Reason::Points);
  begin();
  SUCCEEDS(stream->write_all(encode(++number, PathPoint{.path = 1, .speed = 10, .acceleration = 10}), 1s));
  SUCCEEDS(stream->write_all(encode(++number, PathEnd{.path = 1}), 1s));
  const Body sum = answer();
  CHECK(std::holds_alternative<PathSum>(sum));
  refused(Go{.path = 1, .sum = std::get<PathSum>(sum).sum + 1}, Reason::WrongPath);
  cell.controller->set_powered(false);
  refused(Go{.path = 1, .sum = std::get<PathSum>(sum).sum}, Reason::NotReady);
  CHECK_EQUAL(0U, cell.controller->paths_run());
  // A second host meanwhile.
  auto second = ur::TcpStream::connect({"127.0.0.1", cell.controller->port()}, 5s);
  SUCCEEDS(second);
  SUCCEEDS(second->read_some(bytes, 5s));
  Reader other_reader;
  other_reader.add(bytes);
  const auto busy = other_reader.next();
  CHECK(busy && *busy && std::get<Refusal>((*busy)->body).reason == Reason::Busy);
  // A count that does not go on.
  SUCCEEDS(stream->write_all(encode(number + 2, Beat{}), 1s));
  Result<void> read{};
  for (int i = 0; i < 1000 && read; ++i) read = stream->read_some(bytes, 50ms);
  CHECK_FALSE(read.has_value());
}

}  // namespace biteline::robot
