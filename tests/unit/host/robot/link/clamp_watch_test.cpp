// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/clamp_watch.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>
#include <functional>
#include <memory>

#include "hal/sim/robot/ur_controller.hpp"
#include "tests/unit/host/robot/link/fake_controller.hpp"

namespace biteline::robot::ur {
namespace {

using namespace std::chrono_literals;

constexpr auto k_longest_wait = 20s;  // of a loaded machine
constexpr int k_input = 3;
constexpr std::uint64_t k_closed = 1U << k_input, k_others = 0xF7;

bool comes_true(const std::function<bool()>& holds) {
  const auto until = std::chrono::steady_clock::now() + k_longest_wait;
  while (!holds() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(1ms);
  return holds();
}

}  // namespace

TEST_GROUP(ClampWatch) {
  std::unique_ptr<test::FakeController> controller = std::make_unique<test::FakeController>();
  std::unique_ptr<ClampWatch> sut;

  void teardown() override {
    sut.reset();
    controller.reset();
  }
  void watch(Nanoseconds most_gap = 5s) {
    sut = std::make_unique<ClampWatch>(
        ClampWatch::Config{.rtde_port = controller->rtde_port(), .input = k_input, .most_gap = most_gap});
  }
  /// Pre: the clamp holds.
  HostClock::time_point held() const {
    CHECK(comes_true([this] { return sut->held_since().has_value(); }));
    return sut->held_since().value_or(HostClock::time_point{});
  }
  bool is_held_later_than(HostClock::time_point before) const {
    return comes_true([this, before] {
      const auto since = sut->held_since();
      return since && *since > before;
    });
  }
};

TEST(ClampWatch, AClampThatStaysClosedHasHeldSinceThen) {
  controller->digital_inputs = k_closed;
  watch();
  const HostClock::time_point since = held();
  std::this_thread::sleep_for(300ms);
  CHECK(held() == since);
}

TEST(ClampWatch, AnOpenClampHoldsNothingWhateverTheOtherInputsSay) {
  controller->digital_inputs = k_others;
  watch();
  CHECK(comes_true([this] { return controller->rtde_connections == 1; }));
  std::this_thread::sleep_for(100ms);
  CHECK_FALSE(sut->held_since().has_value());
}

TEST(ClampWatch, OneStateWithoutTheInputEndsIt) {
  controller->digital_inputs = k_closed | k_others;
  watch();
  const HostClock::time_point since = held();
  controller->digital_inputs = k_others;
  CHECK(comes_true([this] { return !sut->held_since(); }));
  controller->digital_inputs = k_closed;
  CHECK(is_held_later_than(since));
}

TEST(ClampWatch, AGapInTheStatesEndsIt) {
  controller->digital_inputs = k_closed;
  watch(150ms);
  const HostClock::time_point since = held();
  controller->silent = true;
  std::this_thread::sleep_for(300ms);
  controller->silent = false;
  CHECK(is_held_later_than(since));
  LONGS_EQUAL(1, controller->rtde_connections);
}

TEST(ClampWatch, NobodyKnowsWhileTheControllerIsSilentOrAway) {
  controller->digital_inputs = k_closed;
  watch();
  held();
  controller->silent = true;
  CHECK(comes_true([this] { return !sut->held_since(); }));
}

TEST(ClampWatch, ANewConnectionBeginsAfresh) {
  controller->digital_inputs = k_closed;
  watch();
  const HostClock::time_point since = held();
  controller->drop = true;
  CHECK(is_held_later_than(since));
  CHECK(controller->rtde_connections > 1);
}

TEST(ClampWatch, AControllerThatIsAwayIsCalledAgain) {
  sut = std::make_unique<ClampWatch>(ClampWatch::Config{.rtde_port = 9});
  std::this_thread::sleep_for(50ms);
  CHECK_FALSE(sut->held_since().has_value());
}

TEST(ClampWatch, TheSimulatedControllerHasTheInput) {
  const sim::ArmKinematics kinematics = *sim::ArmKinematics::named("ur5e");
  sim::Arm arm{kinematics,
               kinematics.T_base_flange((sim::JointVector() << 0.1, -1.4, 1.7, -1.8, -1.5, 0.2).finished())};
  const std::unique_ptr<sim::UrController> simulated = *sim::UrController::open({.rate_hz = 125}, arm, {});
  simulated->set_digital_input(k_input, true);
  sut = std::make_unique<ClampWatch>(
      ClampWatch::Config{.rtde_port = simulated->ports().rtde, .input = k_input, .most_gap = 5s});
  const HostClock::time_point since = held();
  CHECK(held() == since);
  simulated->set_digital_input(k_input, false);
  CHECK(comes_true([this] { return !sut->held_since(); }));
  simulated->set_digital_input(k_input, true);
  CHECK(is_held_later_than(since));
  sut.reset();
}

}  // namespace biteline::robot::ur
