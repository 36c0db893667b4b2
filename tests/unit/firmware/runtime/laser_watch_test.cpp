// SPDX-License-Identifier: MIT
#include "firmware/runtime/laser_watch.hpp"

#include <CppUTest/TestHarness.h>

#include "hal/api/virtual_clock.hpp"
#include "tests/support/errors.hpp"

namespace biteline::runtime {
namespace {

/// What the test sees of the wires.
struct Wires {
  bool laser{true};  // as left by whoever was here before
  bool set_fails{false};
  bool stuck_on{false};
  bool interlock{true};
  bool safety_fails{false};
};

class FakeLaser final : public hal::GpioOut {
 public:
  explicit FakeLaser(Wires& wires) : wires_{wires} {}
  ~FakeLaser() override { wires_.laser = false; }  // the kernel lets go of the line
  Result<void> set(bool active) noexcept override {
    if (wires_.set_fails) return fail(Errc::DeviceError, "laser");
    wires_.laser = active || wires_.stuck_on;
    return {};
  }
  Result<bool> read_back() noexcept override { return wires_.laser; }

 private:
  Wires& wires_;
};

class FakeSafety final : public hal::SafetyIn {
 public:
  explicit FakeSafety(Wires& wires) : wires_{wires} {}
  Result<hal::SafetyInputs> read() noexcept override {
    if (wires_.safety_fails) return fail(Errc::DeviceError, "interlock");
    return hal::SafetyInputs{.interlock_closed = wires_.interlock, .key_on = true, .read_at = {}};
  }

 private:
  Wires& wires_;
};

}  // namespace

TEST_GROUP(LaserWatch) {
  Wires wires;
  hal::VirtualClock clock{SensorClock::time_point{std::chrono::seconds{100}}};
  std::unique_ptr<LaserWatch> sut;

  void setup() override {
    sut = std::make_unique<LaserWatch>(std::make_unique<FakeLaser>(wires), std::make_unique<FakeSafety>(wires), clock,
                                       LaserGuard::Config{});
  }
  void step(bool frames = true) {
    clock.advance(threads::k_safety.period);
    if (frames) sut->note_frame(clock.now());
    sut->note_alive(clock.now());
    sut->step();
  }
  void light_up() {
    sut->ask_for_light(true);
    step();
    CHECK(wires.laser);
    CHECK(sut->status().on);
  }
};

TEST(LaserWatch, DarkensTheLineBeforeAnythingElse) { CHECK(!wires.laser); }

TEST(LaserWatch, LightsWhileAScanAsksAndDarkensWhenItNoLongerDoes) {
  step();
  CHECK(!wires.laser);
  light_up();
  sut->ask_for_light(false);
  step();
  CHECK(!wires.laser);
}

TEST(LaserWatch, LooksThatStayOutAreFoundByTheFrameThreadWithinTheLimit) {
  light_up();
  const SensorClock::time_point last_look = clock.now();
  // The safety thread hangs; frames come on.
  while (wires.laser) {
    clock.advance(std::chrono::milliseconds{20});
    sut->note_alive(clock.now());
    sut->note_frame(clock.now());
  }
  CHECK(clock.now() - last_look <= std::chrono::milliseconds{100});
  CHECK(clock.now() - last_look > std::chrono::milliseconds{50});
  // It comes back: the light does not.
  for (int i = 0; i < 10; ++i) {
    step();
    CHECK(!wires.laser);
  }
  CHECK(sut->status().reason == LaserOff::SafetyHung);
  CHECK(sut->status().state == LaserGuard::State::Latched);
  sut->ask_for_light(false);
  step();
  light_up();
}

TEST(LaserWatch, FramesOfTheScanBeforeLightNothing) {
  light_up();
  sut->ask_for_light(false);
  step();
  sut->ask_for_light(true);
  step(false);
  CHECK(!wires.laser);
  CHECK(sut->status().state == LaserGuard::State::Off);
  step();
  CHECK(wires.laser);
}

TEST(LaserWatch, OpenInterlockDarkensAtTheNextLook) {
  light_up();
  wires.interlock = false;
  step();
  CHECK(!wires.laser);
  CHECK(sut->status().reason == LaserOff::InterlockOpen);
}

TEST(LaserWatch, InterlockThatCannotBeReadIsOpen) {
  light_up();
  wires.safety_fails = true;
  step();
  CHECK(!wires.laser);
}

TEST(LaserWatch, SilentCameraDarkensWithinTheLimit) {
  light_up();
  Nanoseconds lit{0};
  while (wires.laser) {
    step(false);
    lit += threads::k_safety.period;
  }
  CHECK(lit <= std::chrono::milliseconds{100});
  CHECK(sut->status().reason == LaserOff::FramesStopped);
}

TEST(LaserWatch, OutputThatDoesNotObeyIsAFaultAndSaysSo) {
  light_up();
  wires.stuck_on = true;
  sut->ask_for_light(false);
  step();
  CHECK(sut->status().output_lost);
  CHECK(!sut->status().on);
}

TEST(LaserWatch, OutputThatCannotBeToldIsAFault) {
  wires.set_fails = true;
  sut->ask_for_light(true);
  step();
  step();
  CHECK(sut->status().state == LaserGuard::State::Latched);
  CHECK(sut->status().reason == LaserOff::DriverFailed);
}

TEST(LaserWatch, StopIsDarkAndForGood) {
  light_up();
  sut->stop();
  CHECK(!wires.laser);
  step();
  CHECK(!wires.laser);
}

TEST(LaserWatch, GoneIsDark) {
  light_up();
  sut.reset();
  CHECK(!wires.laser);
}

TEST(LaserWatch, ItsThreadLooksByItself) {
  SUCCEEDS(sut->start(RealtimeDemand::Ignored));
  sut->ask_for_light(true);
  // The clock of this test stands still, so one frame stays fresh for ever.
  sut->note_frame(clock.now());
  sut->note_alive(clock.now());
  for (int i = 0; i < 1000 && !sut->status().on; ++i) std::this_thread::sleep_for(std::chrono::milliseconds{1});
  CHECK(sut->status().on);
  sut->stop();
  CHECK(!wires.laser);
}

}  // namespace biteline::runtime
