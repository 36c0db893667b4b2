// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/tool_changer.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>
#include <numbers>
#include <thread>

#include "hal/linux/posix/descriptor.hpp"
#include "hal/sim/robot/ur_controller.hpp"
#include "tests/support/errors.hpp"

namespace biteline::robot::ur {
namespace {

using namespace std::chrono_literals;

constexpr path::ChangerLines k_gun{.ask_output = 4, .there_input = 2},
    k_brush{.ask_output = 5, .there_input = 3};
constexpr std::uint32_t k_gun_asked = 1U << 4U, k_brush_asked = 1U << 5U;

}  // namespace

/// A turret at a simulated controller; the gun stands at first.
TEST_GROUP(ToolChanger) {
  Stops stops;
  sim::Arm arm{*sim::ArmKinematics::named("ur10e"),
               std::numbers::pi / 180 * (sim::JointVector() << 180, -90, 60, 100, 90, 160).finished()};
  std::unique_ptr<sim::UrController> controller;

  void teardown() override {
    controller.reset();
  }
  void open(bool stuck = false) {
    controller = *sim::UrController::open(
        {.turret = sim::TurretFacts{.places = {{k_gun.ask_output, k_gun.there_input},
                                               {k_brush.ask_output, k_brush.there_input}},
                                    .turn_s = 0.4,
                                    .stuck = stuck}},
        arm, {});
  }
  Result<void> change(bool to_brush, const std::string& in_the_way = {}, double patience_s = 20) {
    return change_tool({.rtde_port = controller->ports().rtde, .patience_s = patience_s},
                       {.wanted = to_brush ? k_brush : k_gun, .others = {to_brush ? k_gun : k_brush}},
                       in_the_way, stops.now());
  }
  std::uint32_t outputs() const {
    return arm.at(hal::monotonic_now()).outputs;
  }
  /// What is switched off last is on its way for a cycle or two.
  bool come_to(std::uint32_t wanted) const {
    const auto until = std::chrono::steady_clock::now() + 20s;
    while (outputs() != wanted && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(1ms);
    return outputs() == wanted;
  }
};

TEST(ToolChanger, AsksForNothingWhereTheToolStands) {
  open();
  SUCCEEDS(change(false, "the shoe is near"));
  LONGS_EQUAL(0, outputs());
}

TEST(ToolChanger, AsksUntilTheOtherToolStandsAndGoesOnAsking) {
  open();
  SUCCEEDS(change(true));
  LONGS_EQUAL(k_brush_asked, outputs());
  SUCCEEDS(change(false));
  LONGS_EQUAL(k_gun_asked, outputs());
}

TEST(ToolChanger, ThatNeverStandsIsAskedNoMore) {
  open(true);
  FAILS_NAMING(Errc::Timeout, "does not tell", change(true, {}, 1));
  CHECK(come_to(0));
}

TEST(ToolChanger, TurnsNotWhereSomethingIsInTheWay) {
  open();
  FAILS_NAMING(Errc::CheckFailed, "the shoe is near", change(true, "the shoe is near"));
  LONGS_EQUAL(0, outputs());
}

TEST(ToolChanger, AStopEndsTheAsking) {
  open(true);
  std::thread person{[this] {
    static_cast<void>(come_to(k_brush_asked));
    stops.stop();
  }};
  const Result<void> done = change(true);
  person.join();
  FAILS_NAMING(Errc::WrongState, "stopped", done);
  CHECK(come_to(0));
}

TEST(ToolChanger, AControllerThatIsAwayIsToldAtOnce) {
  open();
  const std::uint16_t port = controller->ports().rtde;
  controller.reset();
  CHECK(change_tool({.rtde_port = port}, {.wanted = k_gun}, {}, stops.now()).error().code ==
        Errc::ConnectFailed);
}

/// The longest tool of all may swing anywhere about the flange.
TEST(ToolChanger, NeedsRoomForItsLongestTool) {
  path::Tool tool{.body_radius_mm = 20};
  tool.T_flange_tcp.translation() = Vec3{0, 0, 150};
  DOUBLES_EQUAL(150 + 20 + 10, room_to_change_mm({}, tool), 1e-12);
  DOUBLES_EQUAL(210 + 20 + 10, room_to_change_mm({.reach_mm = 210}, tool), 1e-12);
}

}  // namespace biteline::robot::ur
