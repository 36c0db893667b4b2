// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/arm_claim.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>

#include "tests/support/errors.hpp"
#include "tests/support/timed_test.hpp"
#include "tests/unit/host/robot/link/fake_controller.hpp"

namespace biteline::robot::ur {
namespace {

/// What the other side does takes its time; no test waits for as long where it is as it should be.
bool comes_to(const ArmClaim& claim, ArmClaim::State state) {
  for (int i = 0; i < 3000 && claim.state() != state; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds{10});
  return claim.state() == state;
}

}  // namespace

TEST_GROUP(ArmClaim) {
  test::FakeController controller;

  ArmClaim::Config config() const {
    return {.rtde_port = controller.rtde_port(), .patience_s = 1};
  }
};

ORDINARY_TIMED_TEST(ArmClaim, SecondOneIsRefusedAndGetsItOnceTheFirstIsGone) {
  auto first = ArmClaim::take(config());
  SUCCEEDS(first);
  CHECK(comes_to(**first, ArmClaim::State::Held));
  const auto second = ArmClaim::take(config());
  CHECK(!second.has_value());
  LONGS_EQUAL(static_cast<int>(Errc::PeerRefused), static_cast<int>(second.error().code));
  STRCMP_CONTAINS("another service holds this arm", second.error().where.c_str());
  first->reset();
  const auto third = ArmClaim::take(config());
  SUCCEEDS(third);
  CHECK(comes_to(**third, ArmClaim::State::Held));
}

ORDINARY_TIMED_TEST(ArmClaim, AnotherRegisterIsAnotherClaim) {
  const auto first = ArmClaim::take(config());
  SUCCEEDS(first);
  ArmClaim::Config other = config();
  other.input_register = 46;
  const auto second = ArmClaim::take(other);
  SUCCEEDS(second);
  CHECK(comes_to(**second, ArmClaim::State::Held));
}

ORDINARY_TIMED_TEST(ArmClaim, LostConnectionIsNotSafeAndComesBack) {
  const auto sut = ArmClaim::take(config());
  SUCCEEDS(sut);
  CHECK(comes_to(**sut, ArmClaim::State::Held));
  controller.drop = true;
  CHECK(comes_to(**sut, ArmClaim::State::Away));
  CHECK(!(*sut)->safe());
  CHECK(comes_to(**sut, ArmClaim::State::Held));
}

ORDINARY_TIMED_TEST(ArmClaim, ControllerThatIsAwayIsNotSafe) {
  ArmClaim::Config away = config();
  away.rtde_port = 1;
  const auto sut = ArmClaim::take(away);
  SUCCEEDS(sut);
  CHECK(!(*sut)->safe());
}

ORDINARY_TIMED_TEST(ArmClaim, ControllerWithoutTheRegisterIsSaidToLackIt) {
  ArmClaim::Config lacking = config();
  lacking.input_register = 48;
  const auto sut = ArmClaim::take(lacking);
  SUCCEEDS(sut);
  CHECK(comes_to(**sut, ArmClaim::State::Lacking));
}

}  // namespace biteline::robot::ur
