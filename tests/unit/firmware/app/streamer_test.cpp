// SPDX-License-Identifier: MIT
// Scans that cannot begin, or end early.  What hosts see of those that do: tests/integration.
#include "firmware/app/streamer.hpp"

#include <CppUTest/TestHarness.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "tests/support/errors.hpp"
#include "tests/support/made_session.hpp"

namespace biteline::sensor {
namespace {

using std::chrono::milliseconds;

struct Bench {
  std::atomic<int> cameras{0};  ///< open ones
  bool camera_starts{true};
  std::atomic<bool> laser{false};
};

class BenchLaser final : public hal::GpioOut {
 public:
  explicit BenchLaser(Bench& bench) : bench_{bench} {}
  Result<void> set(bool active) noexcept override {
    bench_.laser = active;
    return {};
  }
  Result<bool> read_back() noexcept override { return bench_.laser.load(); }

 private:
  Bench& bench_;
};

class ShutDoor final : public hal::SafetyIn {
 public:
  Result<hal::SafetyInputs> read() noexcept override {
    return hal::SafetyInputs{.interlock_closed = true, .key_on = true, .read_at = {}};
  }
};

/// A robot's program that goes its way while there is light.
class RobotInTheLight final : public hal::EdgeIn {
 public:
  explicit RobotInTheLight(Bench& bench) : bench_{bench} {}
  Result<hal::Edge> next_edge(Nanoseconds) override { return fail(Errc::Timeout, "no edge"); }
  Result<bool> level() noexcept override { return bench_.laser.load(); }
  hal::EdgeHealth health() const noexcept override { return {}; }

 private:
  Bench& bench_;
};

class BenchCamera final : public hal::LineCamera {
 public:
  explicit BenchCamera(Bench& bench) : bench_{bench} { ++bench_.cameras; }
  ~BenchCamera() override { --bench_.cameras; }
  Result<hal::CameraLimits> limits() override { return hal::CameraLimits{}; }
  Result<hal::CameraSettings> configure(const hal::CameraSettings& wanted) override { return wanted; }
  Result<void> start() override {
    if (!bench_.camera_starts) return fail(Errc::DeviceError, "camera");
    return {};
  }
  Result<hal::FrameView> next_frame(Nanoseconds) override {
    std::this_thread::sleep_for(milliseconds{1});
    return fail(Errc::Timeout, "no frame");
  }
  void release(const hal::FrameView&) noexcept override {}
  Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override { return exposure; }
  Result<void> stop() override { return {}; }
  hal::CameraHealth health() const noexcept override { return {}; }

 private:
  Bench& bench_;
};

class NoPoses final : public hal::PoseSource {
 public:
  Result<void> start() override { return {}; }
  Result<hal::RobotPose> next_pose(Nanoseconds) override {
    std::this_thread::sleep_for(milliseconds{1});
    return fail(Errc::Timeout, "no pose");
  }
  Result<void> stop() override { return {}; }
  hal::PoseHealth health() const noexcept override { return {}; }
};

class BenchKind final : public SourceKind {
 public:
  explicit BenchKind(Bench& bench) : bench_{bench} {
    model = test::made_sensor({.frames = 1, .width_px = 64, .height_px = 48});
  }
  Result<Source> open() override {
    Source source;
    source.camera = std::make_unique<BenchCamera>(bench_);
    source.poses = std::make_unique<NoPoses>();
    source.scan_active = std::make_unique<RobotInTheLight>(bench_);
    return source;
  }
  Result<std::optional<LaserDevices>> open_laser() override { return std::optional<LaserDevices>{}; }

 private:
  Bench& bench_;
};

}  // namespace

TEST_GROUP(Streamer){};

TEST(Streamer, ScanThatCannotStartLeavesNoDeviceOpenAndTheNextOneWorks) {
  Bench bench;
  BenchKind kind{bench};
  const hal::MonotonicClock clock;
  auto socket = stream::StreamSocket::open({});
  SUCCEEDS(socket);
  StreamerConfig config;
  config.realtime = runtime::RealtimeDemand::Ignored;
  Streamer sut{config, kind, **socket, clock, nullptr};
  bench.camera_starts = false;
  CHECK(sut.start_scan().error().code == Errc::DeviceError);
  for (int i = 0; i < 5000 && bench.cameras > 0; ++i) std::this_thread::sleep_for(milliseconds{1});
  LONGS_EQUAL(0, bench.cameras);
  bench.camera_starts = true;
  SUCCEEDS(sut.start_scan());
  LONGS_EQUAL(1, bench.cameras);
  CHECK(sut.start_scan().error().code == Errc::WrongState);
}

TEST(Streamer, RobotThatStopsForWantOfLightHasNotEndedTheScan) {
  Bench bench;
  BenchKind kind{bench};
  const hal::MonotonicClock clock;
  auto socket = stream::StreamSocket::open({});
  SUCCEEDS(socket);
  runtime::LaserWatch laser{std::make_unique<BenchLaser>(bench), std::make_unique<ShutDoor>(), clock, {}};
  SUCCEEDS(laser.start(runtime::RealtimeDemand::Ignored));
  StreamerConfig config;
  config.realtime = runtime::RealtimeDemand::Ignored;
  Streamer sut{config, kind, **socket, clock, &laser};
  SUCCEEDS(sut.start_scan());
  std::atomic<bool> stop{false};
  std::thread run{[&] { sut.run(stop); }};
  // Frames while it is dark, and then none: the guard turns the light off again.
  for (int i = 0; i < 5000 && !bench.laser; ++i) {
    laser.note_frame(clock.now());
    std::this_thread::sleep_for(milliseconds{1});
  }
  for (int i = 0; i < 5000 && bench.laser; ++i) std::this_thread::sleep_for(milliseconds{1});
  std::this_thread::sleep_for(milliseconds{100});
  stop = true;
  run.join();
  CHECK(sut.failure().has_value());
  STRCMP_CONTAINS("the laser went off", sut.failure()->where.c_str());
}

}  // namespace biteline::sensor
