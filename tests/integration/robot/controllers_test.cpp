// SPDX-License-Identifier: MIT
// The same job on a CB3, an e-Series and a PolyScope X: done, stopped, held and taken at the pendant.
#include <CppUTest/TestHarness.h>

#include <cstdio>
#include <functional>

#include "hal/sim/live/urgency.hpp"
#include "hal/sim/robot/ur_controller.hpp"
#include "host/robot/link/follow.hpp"
#include "host/robot/link/ur/arm_claim.hpp"
#include "host/robot/link/ur/pendant_watch.hpp"
#include "host/robot/link/ur/ur_link.hpp"
#include "tests/integration/robot/short_path.hpp"
#include "tests/support/timed_test.hpp"
#include "tests/unit/host/robot/link/permitted.hpp"

namespace biteline::robot {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;
using Version = std::array<int, 3>;

constexpr Version k_cb3{3, 15, 8}, k_e_series{5, 12, 0}, k_x{10, 14, 0};

SE3 T_base_flange_home(const sim::ArmKinematics& arm) {
  return arm.T_base_flange((sim::JointVector() << 0.0, -1.8, 1.6, -1.4, -1.57, 0.0).finished());
}

/// A controller, its arm, and a service beside it.
struct Cell {
  explicit Cell(const Version& version) {
    // Its threads begin with the rights of the one that makes them.
    const sim::Urgently urgently{sim::k_robot_priority};
    controller = *sim::UrController::open({.version = version}, arm, {});
  }
  [[nodiscard]] ur::DoorPlaces doors() const {
    const auto at = [](std::uint16_t port) { return ur::Endpoint{"127.0.0.1", port}; };
    const sim::UrController::Ports ports = controller->ports();
    return {.dashboard = at(ports.dashboard), .robot_api = at(ports.robot_api), .script = at(ports.primary)};
  }
  [[nodiscard]] sim::ArmState now() const { return arm.at(hal::monotonic_now()); }
  [[nodiscard]] bool tool_on() const { return (now().outputs & 1U) != 0; }

  /// The whole of it; `meanwhile`: once, as soon as the tool is on.
  [[nodiscard]] Result<void> work(FollowReport& report, const std::function<void()>& meanwhile) {
    const sim::UrController::Ports ports = controller->ports();
    const auto claim = ur::ArmClaim::take({.rtde_port = ports.rtde, .patience_s = 20});
    CHECK(claim.has_value());
    const auto link = ur::UrLink::open({.rtde_port = ports.rtde,
                                        .script_port = ports.primary,
                                        .dashboard_port = ports.dashboard,
                                        .robot_api_port = ports.robot_api,
                                        .connect_patience_s = 20,
                                        .claim = claim->get()});
    CHECK_TEXT(link.has_value(), link ? "" : to_line(link.error()).c_str());
    const auto still = wait_until_still(**link, {.turn_rad = k_ringing_rad, .move_mm = k_ringing_mm});
    CHECK(still.has_value());
    std::atomic<bool> over{false};
    std::thread other{[&] {
      while (!over && !tool_on()) std::this_thread::sleep_for(milliseconds{2});
      if (!over) meanwhile();
    }};
    Result<void> done =
        follow(**link, test::permitted(test::short_path(), still->q_rad, said.now()), {}, report);
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
    CHECK(report.sent);
    CHECK_FALSE(now().program_running);
    LONGS_EQUAL(0, now().outputs);
  }

  sim::ArmKinematics kinematics = *sim::ArmKinematics::named("ur5e");
  sim::Arm arm{kinematics, T_base_flange_home(kinematics)};
  std::unique_ptr<sim::UrController> controller;
  Stops said;
};

}  // namespace

TEST_GROUP(Controllers){};

ORDINARY_TIMED_TEST(Controllers, EachDoesTheWholeJob) {
  for (const Version& version : {k_cb3, k_e_series, k_x}) {
    Cell cell{version};
    const auto words = ur::ask_controller(cell.doors(), std::chrono::seconds{20});
    CHECK_TEXT(words.has_value(), words ? "" : to_line(words.error()).c_str());
    std::printf("%s\n", ur::summary(*words).c_str());
    CHECK(!ur::unsupported(*words));
    CHECK(words->remote == (version == k_cb3 ? std::nullopt : std::optional{true}));
    FollowReport report;
    const auto done = cell.work(report, [] {});
    CHECK_TEXT(done.has_value(), done ? "" : to_line(done.error()).c_str());
    CHECK(report.deviation.covered > 0.999);
    LONGS_EQUAL(0, report.ending.stops);
  }
}

ORDINARY_TIMED_TEST(Controllers, AStopInMidPathEndsIt) {
  for (const Version& version : {k_cb3, k_x}) {
    Cell cell{version};
    cell.stops_for("stopped_by_a_person", [&] { cell.said.stop(); });
  }
}

ORDINARY_TIMED_TEST(Controllers, AProtectiveStopIsToldAndNothingIsSentDuringOne) {
  for (const Version& version : {k_cb3, k_x}) {
    Cell cell{version};
    FollowReport report;
    CHECK(!cell.work(report, [&] { cell.controller->set_protective_stop(true); }).has_value());
    STRCMP_EQUAL("protective_stop", report::refusal_row(report.halt->code).name);
    FollowReport none;
    CHECK(!cell.work(none, [] {}).has_value());
    CHECK_FALSE(none.sent);
  }
}

/// Of the e-Series the tests of the dead man tell it.
ORDINARY_TIMED_TEST(Controllers, LocalControlIsAStopOnAPolyScopeXToo) {
  Cell cell{k_x};
  std::atomic<int> taken{0};
  const ur::PendantWatch pendant{{.doors = cell.doors(), .period = milliseconds{20}}, [&] { ++taken; }};
  cell.stops_for("local_control", [&] { cell.controller->set_remote_control(false); });
  const auto until = Clock::now() + std::chrono::seconds{20};
  while (taken == 0 && Clock::now() < until) std::this_thread::sleep_for(milliseconds{5});
  LONGS_EQUAL(1, taken);
  const auto words = ur::ask_controller(cell.doors(), std::chrono::seconds{20});
  CHECK(words.has_value());
  CHECK(words->remote == false);
}

ORDINARY_TIMED_TEST(Controllers, WithoutPowerNothingIsSent) {
  Cell cell{k_x};
  cell.controller->set_powered(false);
  const auto words = ur::ask_controller(cell.doors(), std::chrono::seconds{20});
  CHECK(words.has_value());
  STRCMP_EQUAL("POWER_OFF", words->robot_mode->c_str());
  FollowReport report;
  const auto done = cell.work(report, [] {});
  CHECK(!done.has_value());
  STRCMP_CONTAINS("not powered", to_line(done.error()).c_str());
  CHECK_FALSE(report.sent);
}

}  // namespace biteline::robot
