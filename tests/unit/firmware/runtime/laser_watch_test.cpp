// SPDX-License-Identifier: MIT
#include "firmware/runtime/laser_watch.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "hal/api/virtual_clock.hpp"
#include "tests/support/errors.hpp"

namespace biteline::runtime {
namespace {

/// What the test sees of the wires.
struct Wires {
  std::atomic<bool> laser{true};  // as left by whoever was here before
  bool set_fails{false};
  std::atomic<bool> stuck_on{false};
  // What happens, once, while the safety thread is about to light up, or waits for the level.
  std::function<void()> before_light{}, on_read_back{};
  std::function<void()> at_each_call{};  ///< of any device, before it does anything and after
  bool interlock{true};
  bool safety_fails{false};
};

/// A device's call begins and ends.
class Told {
 public:
  explicit Told(const Wires& wires) : wires_{wires} { tell(); }
  ~Told() { tell(); }
  Told(const Told&) = delete;
  Told& operator=(const Told&) = delete;

 private:
  void tell() const {
    if (wires_.at_each_call) wires_.at_each_call();
  }
  const Wires& wires_;
};

class FakeLaser final : public hal::GpioOut {
 public:
  explicit FakeLaser(Wires& wires) : wires_{wires} {}
  ~FakeLaser() override { wires_.laser = false; }  // the kernel lets go of the line
  Result<void> set(bool active) noexcept override {
    const Told told{wires_};
    if (wires_.set_fails) return fail(Errc::DeviceError, "laser");
    if (active) {
      if (const auto meanwhile = std::exchange(wires_.before_light, {})) meanwhile();
    }
    wires_.laser = active || wires_.stuck_on;
    return {};
  }
  Result<bool> read_back() noexcept override {
    const Told told{wires_};
    if (const auto meanwhile = std::exchange(wires_.on_read_back, {})) meanwhile();
    return wires_.laser.load();
  }

 private:
  Wires& wires_;
};

class FakeWatchdog final : public hal::Watchdog {
 public:
  explicit FakeWatchdog(std::atomic<int>& feeds) : feeds_{feeds} {}
  Result<Nanoseconds> arm(Nanoseconds timeout) override { return timeout; }
  Result<void> feed() noexcept override {
    ++feeds_;
    return {};
  }
  Result<void> disarm() override { return {}; }

 private:
  std::atomic<int>& feeds_;
};

class FakeSafety final : public hal::SafetyIn {
 public:
  explicit FakeSafety(Wires& wires) : wires_{wires} {}
  Result<hal::SafetyInputs> read() noexcept override {
    const Told told{wires_};
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
    sut = std::make_unique<LaserWatch>(std::make_unique<FakeLaser>(wires),
                                       std::make_unique<FakeSafety>(wires), clock, LaserGuard::Config{});
  }
  void step(bool frames = true) {
    clock.advance(threads::k_safety.period);
    if (frames) sut->note_frame(clock.now());
    sut->note_alive(clock.now());
    sut->note_stream(clock.now());
    sut->step();
  }
  /// The safety thread stands still for so long; the frame thread goes on.
  void hang(Nanoseconds duration) {
    for (Nanoseconds past{0}; past < duration; past += std::chrono::milliseconds{20}) {
      clock.advance(std::chrono::milliseconds{20});
      sut->note_alive(clock.now());
      sut->note_stream(clock.now());
      sut->note_frame(clock.now());
    }
  }
  void light_up() {
    sut->ask_for_light(true);
    step();
    CHECK(wires.laser);
    CHECK(sut->status().on);
  }
};

TEST(LaserWatch, DarkensTheLineBeforeAnythingElse) {
  CHECK(!wires.laser);
}

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
  while (wires.laser && clock.now() - last_look < std::chrono::seconds{1}) {
    hang(std::chrono::milliseconds{20});
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

TEST(LaserWatch, OutputThatHangsInTheFirstLightIsDarkenedByTheFrameThread) {
  sut->ask_for_light(true);
  bool dark = false;
  wires.on_read_back = [&] {
    CHECK(wires.laser);
    hang(std::chrono::milliseconds{100});
    dark = !wires.laser;
  };
  step();
  CHECK(dark);
  CHECK(!sut->status().on);
  step();
  CHECK(!wires.laser);
  CHECK(sut->status().reason == LaserOff::SafetyHung);
}

TEST(LaserWatch, LookThatStoodStillDoesNotUndoTheFrameThreadsDarkness) {
  light_up();
  wires.before_light = [&] { hang(std::chrono::milliseconds{100}); };
  step();
  CHECK(!wires.laser);
  step();
  CHECK(!wires.laser);
  CHECK(sut->status().reason == LaserOff::SafetyHung);
}

/// An arm that waits for light stops at the moment the line goes dark, and its host asks for the status at
/// once. The safety thread stands still at each of its calls in turn, before and after: it is never told that
/// the laser shines on, and always why it does not.
TEST(LaserWatch, NobodyWhoSeesTheDarkHearsOfLightWhereverTheSafetyThreadStoodStill) {
  int calls = 1;  // of the devices in one look; known after the first round
  for (int at = 0; at < calls; ++at) {
    setup();
    light_up();
    int call = 0, wrong = 0;
    bool inside = false, hung = false;
    wires.at_each_call = [&] {
      const auto judge = [&] {
        const LaserWatch::Status status = sut->status();
        if (!wires.laser && (status.on || status.reason != LaserOff::SafetyHung)) ++wrong;
      };
      judge();
      if (inside || call++ != at) return;
      inside = hung = true;  // the frame thread's own calls are no place of the safety thread
      hang(std::chrono::milliseconds{100});
      inside = false;
      judge();
    };
    const auto look = [&] {
      step();
      if (!wires.laser) CHECK(!sut->status().on);
    };
    look();
    calls = std::max(calls, call);
    look();
    wires.at_each_call = {};
    LONGS_EQUAL_TEXT(0, wrong, std::to_string(at).c_str());
    CHECK(hung);
    CHECK(!wires.laser);
    CHECK(sut->status().state == LaserGuard::State::Latched);
    CHECK(sut->status().reason == LaserOff::SafetyHung);
  }
  CHECK(calls > 3);
}

/// The same for darkness of the guard's own making: who sees it and asks is told.
TEST(LaserWatch, DarknessOfTheGuardsOwnIsToldBeforeItIsThere) {
  light_up();
  int wrong = 0;
  wires.at_each_call = [&] {
    if (!wires.laser && (sut->status().on || sut->status().reason != LaserOff::InterlockOpen)) ++wrong;
  };
  wires.interlock = false;
  step();
  wires.at_each_call = {};
  LONGS_EQUAL(0, wrong);
  CHECK(!wires.laser);
}

TEST(LaserWatch, EachLookIsCountedWhenItsStatusIsThere) {
  const std::uint64_t looks = sut->status().looks;
  light_up();
  LONGS_EQUAL(looks + 1, sut->status().looks);
}

TEST(LaserWatch, SilentStreamThreadDarkensWithinTheLimit) {
  light_up();
  Nanoseconds lit{0};
  while (wires.laser && lit < std::chrono::seconds{1}) {
    clock.advance(threads::k_safety.period);
    lit += threads::k_safety.period;
    sut->note_frame(clock.now());
    sut->note_alive(clock.now());
    sut->step();
  }
  CHECK(lit <= std::chrono::milliseconds{100});
  CHECK(sut->status().reason == LaserOff::StreamStarved);
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
  while (wires.laser && lit < std::chrono::seconds{1}) {
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
  sut->note_stream(clock.now());
  for (int i = 0; i < 1000 && !sut->status().on; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
  CHECK(sut->status().on);
  sut->stop();
  CHECK(!wires.laser);
}

TEST(LaserWatch, WatchdogsStarveWhileTheOutputDoesNotObey) {
  std::atomic<int> feeds{0};
  sut->feed(std::make_unique<FakeWatchdog>(feeds));
  SUCCEEDS(sut->start(RealtimeDemand::Ignored));
  const auto wait_for = [](const std::function<bool()>& done) {
    for (int i = 0; i < 1000 && !done(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    return done();
  };
  CHECK(wait_for([&] { return feeds > 3; }));
  wires.stuck_on = true;  // lit by nobody, and not to be darkened: only the board can
  CHECK(wait_for([&] { return sut->status().output_lost; }));
  std::this_thread::sleep_for(2 * threads::k_safety.period);
  const int fed = feeds;
  std::this_thread::sleep_for(5 * threads::k_safety.period);
  LONGS_EQUAL(fed, feeds);
  wires.stuck_on = false;
  CHECK(wait_for([&] { return feeds > fed; }));
  sut->stop();
}

}  // namespace biteline::runtime
