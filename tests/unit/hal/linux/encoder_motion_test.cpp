// SPDX-License-Identifier: MIT
// A way counted by an encoder: as the camera's trigger and as the head's pose.
#include <CppUTest/TestHarness.h>

#include <mutex>
#include <thread>
#include <vector>

#include "hal/linux/posix/descriptor.hpp"
#include "hal/linux/pwm/encoder_trigger.hpp"
#include "hal/linux/pwm/pitch_grid.hpp"
#include "hal/linux/socketcan/encoder_pose_source.hpp"
#include "tests/hal/conformance/pwm_out.hpp"
#include "tests/support/errors.hpp"

namespace biteline::hal {
namespace {

/// Stands where it is put.
class FakeEncoder final : public EncoderIn {
 public:
  FakeEncoder(std::atomic<std::int64_t>& position, std::atomic<int>& reads)
      : position_{position}, reads_{reads} {}
  Result<EncoderReading> read() noexcept override {
    const EncoderReading reading{.position_ticks = position_, .stamp = monotonic_now(), .errors = 0};
    ++reads_;
    return reading;
  }

 private:
  std::atomic<std::int64_t>& position_;
  std::atomic<int>& reads_;
};

class CountedLine final : public GpioOut {
 public:
  explicit CountedLine(std::atomic<int>& rises) : rises_{rises} {}
  Result<void> set(bool active) noexcept override {
    rises_ += active && !active_ ? 1 : 0;
    active_ = active;
    return {};
  }
  Result<bool> read_back() noexcept override { return active_; }

 private:
  std::atomic<int>& rises_;
  bool active_{false};
};

}  // namespace

TEST_GROUP(EncoderMotion) {
  std::atomic<std::int64_t> position{0};
  std::atomic<int> rises{0}, reads{0};

  /// The first look fixes where the way begins.
  void await_first_look() {
    while (reads == 0) std::this_thread::yield();
  }

  std::unique_ptr<EncoderTrigger> trigger() {
    return EncoderTrigger::open(std::make_unique<FakeEncoder>(position, reads),
                                std::make_unique<CountedLine>(rises), {.pitch_ticks = 100})
        .value();
  }
};

TEST(EncoderMotion, PitchesAreCountedBothWaysAndTremblingIsNone) {
  PitchGrid sut{100};
  LONGS_EQUAL(0, sut.on_position(1234));
  LONGS_EQUAL(0, sut.on_position(1333));
  LONGS_EQUAL(1, sut.on_position(1334));
  for (const std::int64_t trembling : {1333, 1334, 1335, 1330, 1334})
    LONGS_EQUAL(0, sut.on_position(trembling));
  LONGS_EQUAL(3, sut.on_position(1634));
  LONGS_EQUAL(1, sut.on_position(1530));
  LONGS_EQUAL(0, sut.on_position(1500));
}

TEST(EncoderMotion, TriggerConforms) {
  conformance::check_pwm_out(*trigger());
}

TEST(EncoderMotion, EachPitchMakesOnePulseAndStandingStillNone) {
  const auto sut = trigger();
  SUCCEEDS(
      sut->configure({.period = std::chrono::microseconds{600}, .pulse = std::chrono::microseconds{100}}));
  SUCCEEDS(sut->start());
  await_first_look();
  for (int pitch = 1; pitch <= 10; ++pitch) {
    const std::uint64_t before = sut->trigger_health().pulses;
    position += 100;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{5};
    while (sut->trigger_health().pulses == before && std::chrono::steady_clock::now() < deadline)
      std::this_thread::yield();
  }
  std::this_thread::sleep_for(std::chrono::milliseconds{10});
  SUCCEEDS(sut->stop());
  const EncoderTriggerHealth health = sut->trigger_health();
  LONGS_EQUAL(rises.load(), health.pulses);
  LONGS_EQUAL(10, health.pulses);
  LONGS_EQUAL(0, health.pitches_missed + health.line_faults + health.read_failures);
}

TEST(EncoderMotion, PitchesFasterThanTheCameraAreCountedAsMissed) {
  const auto sut = trigger();
  SUCCEEDS(sut->configure({.period = std::chrono::seconds{10}, .pulse = std::chrono::microseconds{100}}));
  SUCCEEDS(sut->start());
  await_first_look();
  position += 700;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{5};
  while (sut->trigger_health().pitches_missed < 6 && std::chrono::steady_clock::now() < deadline)
    std::this_thread::yield();
  SUCCEEDS(sut->stop());
  LONGS_EQUAL(1, sut->trigger_health().pulses);
  LONGS_EQUAL(6, sut->trigger_health().pitches_missed);
}

TEST(EncoderMotion, PoseIsTheWayAlongTheAxis) {
  const MonotonicClock clock;
  Twist turntable = Twist::Zero();
  turntable[5] = 1e-3;  // a milliradian about base's z for each tick
  SE3 T_start = SE3::Identity();
  T_start.translation() = Vec3{200, 0, 50};
  EncoderPoseSource sut{std::make_unique<FakeEncoder>(position, reads),
                        clock,
                        {.per_tick = turntable, .T_base_flange_start = T_start}};
  CHECK(sut.next_pose(Nanoseconds{0}).error().code == Errc::WrongState);
  SUCCEEDS(sut.start());
  position = 500;
  const auto pose = sut.next_pose(std::chrono::milliseconds{100});
  SUCCEEDS(pose);
  DOUBLES_EQUAL(200 * std::cos(0.5), pose->T_base_flange.translation().x(), 1e-9);
  DOUBLES_EQUAL(200 * std::sin(0.5), pose->T_base_flange.translation().y(), 1e-9);
  DOUBLES_EQUAL(50, pose->T_base_flange.translation().z(), 1e-9);
  CHECK(pose->encoder_ticks == 500);
  const auto next = sut.next_pose(std::chrono::milliseconds{100});
  SUCCEEDS(next);
  CHECK(*next->stamp_sensor > *pose->stamp_sensor);
  CHECK(sut.health().state == PoseState::Streaming);
}

}  // namespace biteline::hal
