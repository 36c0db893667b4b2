// SPDX-License-Identifier: MIT
// The hand-over between the threads of a scan, with a camera and poses as fast as they can be asked for. Also
// to be run under the thread sanitizer (preset tsan).
#include "firmware/app/scanner.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>
#include <thread>
#include <vector>

#include "tests/support/errors.hpp"
#include "tests/support/made_session.hpp"

namespace biteline::sensor {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t k_frame_period_ns = 1'000'000;
constexpr std::int64_t k_first_ns = 1'000'000'000;
constexpr std::int64_t k_tick_ns = 1000;  ///< an encoder that tells the time in its own unit

/// One picture for ever, a stamp per frame; skips a number now and then as a camera that loses frames.
class FastCamera final : public hal::LineCamera {
 public:
  FastCamera(const geometry::SensorModel& sensor, std::uint64_t frames) : sensor_{sensor}, frames_{frames} {
    pixels_.assign(static_cast<std::size_t>(sensor.region.width_px * sensor.region.height_px), 5);
    for (int column = 0; column < sensor.region.width_px; ++column) {
      for (int row = 18; row < 23; ++row)
        pixels_[static_cast<std::size_t>(row * sensor.region.width_px + column)] = row == 20 ? 200 : 90;
    }
  }
  Result<hal::CameraLimits> limits() override { return hal::CameraLimits{}; }
  Result<hal::CameraSettings> configure(const hal::CameraSettings& wanted) override { return wanted; }
  Result<void> start() override { return {}; }
  Result<hal::FrameView> next_frame(Nanoseconds) override {
    if (fail_at && given_ == *fail_at) return fail(Errc::DeviceLost, "camera gone");
    if (given_ == frames_) {
      std::this_thread::sleep_for(milliseconds{1});
      return fail(Errc::Timeout, "no frame");
    }
    const std::uint64_t frame = given_++;
    return hal::FrameView{.pixels = pixels_,
                          .width_px = sensor_.region.width_px,
                          .height_px = sensor_.region.height_px,
                          .stride_bytes = static_cast<std::size_t>(sensor_.region.width_px),
                          .sequence = frame,
                          .exposure_mid = SensorClock::time_point{Nanoseconds{
                              k_first_ns + static_cast<std::int64_t>(frame) * k_frame_period_ns +
                              (frame >= pause_before ? pause.count() : 0)}},
                          .flags = 0};
  }
  void release(const hal::FrameView&) noexcept override { ++released; }
  Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override { return exposure; }
  Result<void> stop() override { return {}; }
  hal::CameraHealth health() const noexcept override {
    hal::CameraHealth health;
    health.frames = given_;
    health.finished = given_ == frames_;
    return health;
  }

  std::optional<std::uint64_t> fail_at;
  std::uint64_t pause_before{0};  ///< this frame's exposure is `pause` later, and all after it
  Nanoseconds pause{0};
  std::atomic<std::uint64_t> released{0};

 private:
  geometry::SensorModel sensor_;
  std::uint64_t frames_;
  std::atomic<std::uint64_t> given_{0};
  std::vector<std::uint8_t> pixels_;
};

/// A steady motion sampled at 500 Hz, from a little before the first frame to a little after the last.
class FastPoses final : public hal::PoseSource {
 public:
  explicit FastPoses(std::uint64_t frames)
      : count_{(frames * k_frame_period_ns + 200'000'000) / k_period_ns} {}
  Result<void> start() override { return {}; }
  Result<hal::RobotPose> next_pose(Nanoseconds) override {
    if (given_ == count_) {
      std::this_thread::sleep_for(milliseconds{1});
      return fail(Errc::Timeout, "no pose");
    }
    const auto time_ns = k_first_ns - 100'000'000 + static_cast<std::int64_t>(given_) * k_period_ns;
    hal::RobotPose sample;
    sample.stamp = RobotClock::time_point{Nanoseconds{time_ns}};
    sample.T_base_flange.translation().x() = 1e-9 * static_cast<double>(time_ns);
    sample.encoder_ticks = time_ns / k_tick_ns;
    sample.sequence = given_++;
    return sample;
  }
  Result<void> stop() override { return {}; }
  hal::PoseHealth health() const noexcept override {
    hal::PoseHealth health;
    health.poses = given_;
    health.state = given_ == count_ ? hal::PoseState::Finished : hal::PoseState::Streaming;
    return health;
  }

 private:
  static constexpr std::int64_t k_period_ns = 2'000'000;
  std::uint64_t count_;
  std::atomic<std::uint64_t> given_{0};
};

}  // namespace

TEST_GROUP(Scanner) {
  static constexpr std::uint64_t k_frames = 2000;
  hal::MonotonicClock clock;
  FastCamera* camera{nullptr};
  Scanner::Config config;

  std::unique_ptr<Scanner> make(bool lossless) {
    config.model = test::made_sensor({.frames = 1, .width_px = 64, .height_px = 48});
    config.model.pose_clock_offset = Nanoseconds{0};
    config.lossless = lossless;
    config.realtime = runtime::RealtimeDemand::Ignored;
    Source source;
    auto fast = std::make_unique<FastCamera>(config.model, k_frames);
    camera = fast.get();
    source.camera = std::move(fast);
    source.poses = std::make_unique<FastPoses>(k_frames);
    auto scanner = Scanner::create(std::move(source), config, clock, nullptr);
    SUCCEEDS(scanner);
    return std::move(*scanner);
  }
};

TEST(Scanner, LosslessSourceWaitsAndEveryProfileArrivesWithItsPose) {
  const auto sut = make(true);
  SUCCEEDS(sut->start());
  std::uint64_t taken = 0;
  while (!sut->finished()) {
    const profile::ProfileBuffer* profile = sut->take();
    if (profile == nullptr) {
      std::this_thread::yield();
      continue;
    }
    CHECK_EQUAL(taken, profile->header.sequence);
    CHECK_EQUAL(taken, profile->header.frame_sequence);
    CHECK_EQUAL(0U, profile->header.flags & profile::k_profile_not_usable);
    // The pose is linear in time, so smoothing must leave it where it is: 1 mm/s, good to a nanometre.
    const double expected_mm =
        1e-9 * static_cast<double>(profile->header.exposure_mid.time_since_epoch().count());
    DOUBLES_EQUAL(expected_mm, profile->header.T_base_flange.translation().x(), 1e-6);
    CHECK(profile->header.encoder_ticks ==
          profile->header.exposure_mid.time_since_epoch().count() / k_tick_ns);
    CHECK(profile->count > 0);
    sut->give_back();
    ++taken;
    if (taken % 500 == 0) std::this_thread::sleep_for(milliseconds{5});  // a slow consumer now and then
  }
  CHECK_EQUAL(k_frames, taken);
  CHECK_EQUAL(k_frames, sut->counts().profiles);
  CHECK_EQUAL(0U, sut->counts().profiles_dropped);
  CHECK_EQUAL(k_frames, camera->released.load());
  CHECK(!sut->failure());
}

TEST(Scanner, LiveSourceIsNeverWaitedForAndEveryDropIsCounted) {
  const auto sut = make(false);
  SUCCEEDS(sut->start());
  std::uint64_t taken = 0;
  std::uint64_t missing = 0;
  std::uint64_t next = 0;
  // Nobody takes anything until the camera has given everything: it was not held up.
  while (camera->released < k_frames) std::this_thread::yield();
  while (!sut->finished()) {
    const profile::ProfileBuffer* profile = sut->take();
    if (profile == nullptr) continue;
    missing += profile->header.sequence - next;
    next = profile->header.sequence + 1;
    sut->give_back();
    ++taken;
  }
  CHECK_EQUAL(k_frames, next);
  CHECK_EQUAL(k_frames, taken + missing);
  CHECK_EQUAL(missing, sut->counts().profiles_dropped);
  CHECK(missing > 0);
}

TEST(Scanner, TakingWhileTheRingRunsOverLosesNoCount) {
  const auto sut = make(false);
  SUCCEEDS(sut->start());
  std::uint64_t taken = 0;
  std::uint64_t last = 0;
  while (!sut->finished()) {
    const profile::ProfileBuffer* profile = sut->take();
    if (profile == nullptr) continue;
    CHECK(taken == 0 || profile->header.sequence > last);
    last = profile->header.sequence;
    sut->give_back();
    ++taken;
  }
  CHECK_EQUAL(k_frames, taken + sut->counts().profiles_dropped);
}

TEST(Scanner, FailingCameraEndsTheScanWithItsReasonAfterWhatCameBefore) {
  const auto sut = make(true);
  camera->fail_at = 10;
  SUCCEEDS(sut->start());
  std::uint64_t taken = 0;
  while (!sut->finished()) {
    if (sut->take() == nullptr) continue;
    sut->give_back();
    ++taken;
  }
  CHECK_EQUAL(10U, taken);
  CHECK(sut->failure().has_value());
  STRCMP_CONTAINS("camera gone", to_line(*sut->failure()).c_str());
}

TEST(Scanner, PauseOfTheFramesIsMeasured) {
  constexpr Nanoseconds k_pause{500'000'000}, k_after_the_last{700'000'000}, k_period{k_frame_period_ns};
  const auto sut = make(true);
  camera->pause_before = 10;
  camera->pause = k_pause;
  camera->fail_at = 20;
  SUCCEEDS(sut->start());
  while (!sut->finished()) {
    if (sut->take() != nullptr) sut->give_back();
  }
  const SensorClock::time_point last{Nanoseconds{k_first_ns} + 19 * k_period + k_pause};
  CHECK(sut->longest_pause(last) == k_pause + k_period);
  CHECK(sut->longest_pause(last + k_after_the_last) == k_after_the_last);
}

TEST(Scanner, StopsWhileTheSourceWaitsForIt) {
  const auto sut = make(true);
  SUCCEEDS(sut->start());
  while (sut->counts().profiles == 0) std::this_thread::yield();
  sut->stop();
  CHECK(sut->counts().profiles < k_frames);
}

}  // namespace biteline::sensor
