// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/ur_link.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/robot/link/follow.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/timed_test.hpp"
#include "tests/unit/host/robot/link/fake_controller.hpp"
#include "tests/unit/host/robot/link/permitted.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot::ur {
namespace {

// Generous: a busy machine must not fail the test, and a right answer comes in milliseconds.
constexpr Nanoseconds k_patience{20'000'000'000};

}  // namespace

TEST_GROUP(UrLink) {
  test::FakeController controller;

  UrLink::Config config() {
    return config_of(controller);
  }

  static UrLink::Config config_of(const test::FakeController& controller) {
    return {.host = "127.0.0.1",
            .rtde_port = controller.rtde_port(),
            .script_port = controller.script_port(),
            .dashboard_port = controller.dashboard_port(),
            .rate_hz = 0,
            .connect_patience_s = 20};
  }

  /// Waits for states until `enough` says so.
  template <class Enough>
  bool wait_until(const RobotLink& link, Enough enough) {
    std::uint64_t sequence = 0;
    for (int i = 0; i < 20000; ++i) {
      const auto state = link.wait_newer(sequence, k_patience);
      if (!state) return false;
      if (enough(*state)) return true;
      sequence = state->sequence;
    }
    return false;
  }
};

ORDINARY_TIMED_TEST(UrLink, StatesArriveInOurUnits) {
  const auto link = UrLink::open(config());
  CHECK(link.has_value());
  const auto state = (*link)->wait_newer(0, k_patience);
  CHECK(state.has_value());
  DOUBLES_EQUAL(0.0, (state->T_base_tcp.translation() - Vec3{500, -250, 125}).norm(), 1e-9);
  DOUBLES_EQUAL(150, state->T_flange_tcp.translation().z(), 1e-9);
  DOUBLES_EQUAL(3.0, geometry::log_so3(state->T_base_tcp.linear()).y(), 1e-9);
  CHECK(state->powered && !state->program_running && state->safety == Safety::Normal);
  CHECK(state->sampled.time_since_epoch() > Nanoseconds{10'000'000'000});
}

ORDINARY_TIMED_TEST(UrLink, AnArmThatStandsIsToldWithItsJoints) {
  const auto link = UrLink::open(config());
  CHECK(link.has_value());
  const auto state = wait_until_still(**link, {.still_s = 0.02});
  CHECK(state.has_value());
  CHECK(state->sequence > 1);  // not the first that came
}

ORDINARY_TIMED_TEST(UrLink, AnArmThatMovesIsWaitedForUntilItStands) {
  controller.turning = true;
  const auto link = UrLink::open(config());
  CHECK(link.has_value());
  std::thread operation{[&] {
    static_cast<void>(wait_until(**link, [](const RobotState& s) { return s.q_rad[0] > 0.5; }));
    controller.turning = false;
  }};
  const auto state = wait_until_still(**link, {.still_s = 0.05});
  operation.join();
  CHECK(state.has_value());
  CHECK(state->q_rad[0] > 0.5);
  DOUBLES_EQUAL((*link)->latest()->q_rad[0], state->q_rad[0], 1e-12);
}

ORDINARY_TIMED_TEST(UrLink, AnArmThatNeverStandsIsGivenUp) {
  controller.turning = true;
  const auto link = UrLink::open(config());
  CHECK(link.has_value());
  const auto state = wait_until_still(**link, {.patience_s = 0.3, .still_s = 0.1});
  FAILS_NAMING(Errc::Timeout, "it still moves", state);
}

ORDINARY_TIMED_TEST(UrLink, AnArmThatRingsStandsForAPathButNotForAStop) {
  test::FakeController ringing{
      [](test::PlayedState& state) { state.q[0] = 1.5e-4 * std::sin(62.8 * state.time_s); }, 0.002};
  const auto link = UrLink::open(config_of(ringing));
  CHECK(link.has_value());
  CHECK(wait_until_still(**link, {.patience_s = 0.5, .turn_rad = k_ringing_rad, .move_mm = k_ringing_mm})
            .has_value());
  CHECK_FALSE(wait_until_still(**link, {.patience_s = 0.5}).has_value());
}

ORDINARY_TIMED_TEST(UrLink, AnArmThatCreepsDoesNotStandForAPath) {
  constexpr double k_rad_s = 0.02;
  test::FakeController creeping{[&](test::PlayedState& state) { state.q[0] = k_rad_s * state.time_s; },
                                0.002};
  const auto link = UrLink::open(config_of(creeping));
  CHECK(link.has_value());
  CHECK_FALSE(
      wait_until_still(**link, {.patience_s = 0.5, .turn_rad = k_ringing_rad, .move_mm = k_ringing_mm})
          .has_value());
}

ORDINARY_TIMED_TEST(UrLink, AnArmWhoseStatesComeLateDoesNotStandByOurClockAlone) {
  // Each state is a fiftieth of what it should be newer than the one before; between two the arm hardly
  // moves.
  constexpr double k_rad_s = 0.5;
  test::FakeController late{[&](test::PlayedState& state) { state.q[0] = k_rad_s * state.time_s; }, 0.00004};
  const auto link = UrLink::open(config_of(late));
  CHECK(link.has_value());
  // It is told as that, and not as an arm that moves.
  FAILS_NAMING(Errc::Timeout, "its states come late",
               wait_until_still(**link, {.patience_s = 0.5, .turn_rad = 0.1}));
}

ORDINARY_TIMED_TEST(UrLink, BrokenConnectionComesBackWithTheRecipe) {
  const auto link = UrLink::open(config());
  CHECK(link.has_value());
  const std::uint64_t before = (*link)->status().connections;
  controller.drop = true;
  CHECK(wait_until(**link, [&](const RobotState&) { return (*link)->status().connections > before; }));
  const std::uint64_t states = (*link)->status().states;
  CHECK(wait_until(**link, [&](const RobotState&) { return (*link)->status().states > states + 5; }));
  CHECK((*link)->status().connected);
}

ORDINARY_TIMED_TEST(UrLink, PathIsSentOnlyToASafePoweredIdleArm) {
  const path::CheckedPath path = test::planned_path("grind.yaml");
  const auto link = UrLink::open(config());
  CHECK(link.has_value());

  controller.safety_mode = 3;  // protective stop
  CHECK(wait_until(**link, [](const RobotState& s) { return s.safety == Safety::Stopped; }));
  CHECK((*link)->send(test::permitted(path)).error().code == Errc::InterlockOpen);
  controller.safety_mode = 1;
  controller.robot_mode = 5;  // idle: brakes on
  CHECK(wait_until(**link, [](const RobotState& s) { return !s.powered && s.safety == Safety::Normal; }));
  CHECK((*link)->send(test::permitted(path)).error().code == Errc::PeerRefused);
  controller.robot_mode = 7;
  controller.runtime_state = 2;
  CHECK(wait_until(**link, [](const RobotState& s) { return s.powered && s.program_running; }));
  CHECK((*link)->send(test::permitted(path)).error().code == Errc::PeerRefused);
  CHECK(controller.script().empty());

  controller.runtime_state = 1;
  CHECK(wait_until(**link, [](const RobotState& s) { return !s.program_running; }));
  const PermittedPath elsewhere = test::permitted(path, kinematics::Joints::Constant(0.01));
  CHECK((*link)->send(elsewhere).error().code == Errc::Refused);
  CHECK(controller.script().empty());
  CHECK((*link)->send(test::permitted(path)).has_value());
  CHECK(wait_until(**link, [&](const RobotState&) { return controller.script().ends_with("end\n"); }));
  CHECK(controller.script().starts_with("def biteline_path():"));
}

TEST(UrLink, StatesWithoutNumbersAreNotHandedOut) {
  controller.not_a_number = true;
  UrLink::Config impatient = config();
  impatient.connect_patience_s = 0.3;
  CHECK_FALSE(UrLink::open(impatient).has_value());
}

ORDINARY_TIMED_TEST(UrLink, SilentControllerIsStaleThenLost) {
  const auto link = UrLink::open(config());
  CHECK(link.has_value());
  controller.silent = true;
  std::uint64_t sequence = 0;
  for (auto state = (*link)->wait_newer(0, k_patience); state;
       state = (*link)->wait_newer(sequence, Nanoseconds{400'000'000})) {
    sequence = state->sequence;
  }
  const auto state = (*link)->latest();
  CHECK_FALSE(state.has_value());
  CHECK(state.error().code == Errc::PoseStale || state.error().code == Errc::ConnectionLost);
}

ORDINARY_TIMED_TEST(UrLink, NobodyThereIsToldAtOnce) {
  UrLink::Config wrong = config();
  wrong.rtde_port = 1;  // nobody listens on it
  const auto link = UrLink::open(wrong);
  CHECK_FALSE(link.has_value());
  CHECK(link.error().code == Errc::ConnectFailed);
}

}  // namespace biteline::robot::ur
