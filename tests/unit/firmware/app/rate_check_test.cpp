// SPDX-License-Identifier: MIT
#include "firmware/app/rate_check.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>
#include <thread>
#include <vector>

#include "tests/support/errors.hpp"
#include "tests/support/made_session.hpp"

namespace biteline::sensor {
namespace {

using namespace std::chrono_literals;

/// A picture each millisecond, for as long as it is asked.
class TickingCamera final : public hal::LineCamera {
 public:
  TickingCamera(const geometry::SensorModel& sensor, const hal::Clock& clock)
      : sensor_{sensor}, clock_{clock} {
    pixels_.assign(static_cast<std::size_t>(sensor.region.width_px * sensor.region.height_px), 5);
    for (int column = 0; column < sensor.region.width_px; ++column)
      pixels_[static_cast<std::size_t>(20 * sensor.region.width_px + column)] = 200;
  }
  Result<hal::CameraLimits> limits() override { return hal::CameraLimits{}; }
  Result<hal::CameraSettings> configure(const hal::CameraSettings& wanted) override { return wanted; }
  Result<void> start() override { return {}; }
  Result<hal::FrameView> next_frame(Nanoseconds) override {
    std::this_thread::sleep_for(1ms);
    return hal::FrameView{.pixels = pixels_,
                          .width_px = sensor_.region.width_px,
                          .height_px = sensor_.region.height_px,
                          .stride_bytes = static_cast<std::size_t>(sensor_.region.width_px),
                          .sequence = given_++,
                          .exposure_mid = clock_.now(),
                          .flags = 0};
  }
  void release(const hal::FrameView&) noexcept override {}
  Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override { return exposure; }
  Result<void> stop() override { return {}; }
  hal::CameraHealth health() const noexcept override { return {}; }

 private:
  geometry::SensorModel sensor_;
  const hal::Clock& clock_;
  std::atomic<std::uint64_t> given_{0};
  std::vector<std::uint8_t> pixels_;
};

/// A controller that is switched off, or one that stands still.
class Poses final : public hal::PoseSource {
 public:
  Poses(const hal::Clock& clock, bool answers) : clock_{clock}, answers_{answers} {}
  Result<void> start() override { return {}; }
  Result<hal::RobotPose> next_pose(Nanoseconds) override {
    std::this_thread::sleep_for(2ms);
    if (!answers_) return fail(Errc::Timeout, "RTDE pose");
    hal::RobotPose pose;
    pose.stamp = RobotClock::time_point{clock_.now().time_since_epoch()};
    pose.sequence = given_++;
    return pose;
  }
  Result<void> stop() override { return {}; }
  hal::PoseHealth health() const noexcept override {
    hal::PoseHealth health;
    health.state = answers_ ? hal::PoseState::Streaming : hal::PoseState::Connecting;
    return health;
  }

 private:
  const hal::Clock& clock_;
  bool answers_;
  std::uint64_t given_{0};
};

class Kind final : public SourceKind {
 public:
  Kind(const hal::Clock& clock, bool answers) : clock_{clock}, answers_{answers} {
    model = test::made_sensor({.frames = 1, .width_px = 64, .height_px = 48});
    model.pose_clock_offset = Nanoseconds{0};
    model.rate_hz = 5;
  }
  Result<Source> open() override {
    Source source;
    source.camera = std::make_unique<TickingCamera>(model, clock_);
    source.poses = std::make_unique<Poses>(clock_, answers_);
    return source;
  }
  Result<std::optional<LaserDevices>> open_laser() override { return std::optional<LaserDevices>{}; }

 private:
  const hal::Clock& clock_;
  bool answers_;
};

}  // namespace

TEST_GROUP(RateCheck) {
  hal::MonotonicClock clock;

  RateCheck check(bool robot_answers) {
    Kind kind{clock, robot_answers};
    Scanner::Config config;
    config.model = kind.model;
    config.realtime = runtime::RealtimeDemand::Ignored;
    const Result<RateCheck> checked = check_rate(kind, config, clock, 400ms);
    SUCCEEDS(checked);
    return *checked;
  }
};

TEST(RateCheck, WithoutARobotThePosesAreLackingAndNotTheRate) {
  const RateCheck sut = check(false);
  DOUBLES_EQUAL(1.0, sut.no_pose_ratio, 1e-9);
  CHECK(sut.poses_lacked());
}

TEST(RateCheck, WithARobotNothingIsLacking) {
  const RateCheck sut = check(true);
  CHECK_FALSE(sut.poses_lacked());
  CHECK(sut.profiles_hz > 0);
}

}  // namespace biteline::sensor
