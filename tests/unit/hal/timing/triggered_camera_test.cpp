// SPDX-License-Identifier: MIT
#include "hal/timing/triggered_camera.hpp"

#include <CppUTest/TestHarness.h>

#include <deque>

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds k_period = 10ms;
constexpr Nanoseconds k_exposure = 2ms;

SensorClock::time_point at(Nanoseconds since_start) {
  return SensorClock::time_point{5s} + since_start;
}

struct FakeCamera final : LineCamera {
  std::deque<FrameView> frames;
  Result<CameraLimits> limits() override { return CameraLimits{}; }
  Result<CameraSettings> configure(const CameraSettings& wanted) override { return wanted; }
  Result<void> start() override { return {}; }
  Result<FrameView> next_frame(Nanoseconds) override {
    if (frames.empty()) return fail(Errc::Timeout, "fake");
    const FrameView frame = frames.front();
    frames.pop_front();
    return frame;
  }
  void release(const FrameView&) noexcept override {}
  Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override { return exposure; }
  Result<void> stop() override { return {}; }
  CameraHealth health() const noexcept override { return {}; }
};

struct FakeStrobe final : EdgeIn {
  std::deque<Edge> edges;
  bool broken{false};
  Result<Edge> next_edge(Nanoseconds) override {
    if (broken) return fail(Errc::DeviceLost, "fake");
    if (edges.empty()) return fail(Errc::Timeout, "fake");
    const Edge edge = edges.front();
    edges.pop_front();
    return edge;
  }
  Result<bool> level() noexcept override { return false; }
  EdgeHealth health() const noexcept override { return {}; }
};

TEST_GROUP(TriggeredCamera) {
  FakeCamera* camera = new FakeCamera;
  FakeStrobe* strobe = new FakeStrobe;
  TriggeredCamera sut{std::unique_ptr<LineCamera>{camera},
                      std::unique_ptr<EdgeIn>{strobe},
                      {.pairing = {.latency_min = -1ms, .latency_max = 3ms}}};

  void setup() override {
    strobe->edges.push_back({.stamp = at(-20ms), .rising = true});  // from before the start
    CHECK(sut.configure({.region = {}, .exposure = k_exposure, .rate_hz = 100, .trigger = Trigger::Hardware})
              .has_value());
    CHECK(sut.start().has_value());
  }
  void edge(Nanoseconds stamp) {
    strobe->edges.push_back({.stamp = at(stamp), .rising = true});
    strobe->edges.push_back({.stamp = at(stamp + k_exposure), .rising = false});
  }
  /// The camera's own idea of mid-exposure is half a millisecond late.
  void frame(Nanoseconds exposure_start) {
    FrameView view;
    view.exposure_mid = at(exposure_start + k_exposure / 2 + 500us);
    view.flags = k_frame_stamp_uncertain;
    camera->frames.push_back(view);
  }
};

TEST(TriggeredCamera, MidExposureComesFromTheEdge) {
  for (int i = 0; i < 5; ++i) {
    edge(i * k_period);
    frame(i * k_period);
    const Result<FrameView> got = sut.next_frame(0ns);
    CHECK(got->exposure_mid == at(i * k_period + 1ms));
    CHECK_EQUAL(0, got->flags);
  }
  CHECK_EQUAL(5, sut.health().trigger.frames_paired);
  CHECK_EQUAL(0, sut.health().trigger.edges_without_frame);
}

TEST(TriggeredCamera, LostEdgeFlagsItsFrameAndNoOther) {
  for (int i = 0; i < 5; ++i) {
    if (i != 2) edge(i * k_period);
    frame(i * k_period);
    const Result<FrameView> got = sut.next_frame(0ns);
    CHECK_EQUAL(i == 2 ? k_frame_trigger_mismatch | k_frame_stamp_uncertain : 0, got->flags);
  }
  CHECK_EQUAL(1, sut.health().trigger.frames_without_edge);
  CHECK_EQUAL(1, sut.health().trigger.edges_missed);
}

TEST(TriggeredCamera, DoubledEdgeIsCountedAndDoesNotSpoilTheFrame) {
  for (int i = 0; i < 3; ++i) {
    edge(i * k_period);
    if (i == 1) edge(i * k_period + 300us);
    frame(i * k_period);
    CHECK(sut.next_frame(0ns)->exposure_mid == at(i * k_period + 1ms));
  }
  CHECK_EQUAL(1, sut.health().trigger.edges_doubled);
}

TEST(TriggeredCamera, LostFrameLeavesItsEdgeCounted) {
  for (int i = 0; i < 5; ++i) {
    edge(i * k_period);
    if (i == 2) continue;
    frame(i * k_period);
    CHECK(sut.next_frame(0ns)->exposure_mid == at(i * k_period + 1ms));
  }
  CHECK_EQUAL(1, sut.health().trigger.edges_without_frame);
}

TEST(TriggeredCamera, BrokenStrobeLineCostsThePairingAndNotTheFrames) {
  strobe->broken = true;
  frame(0ms);
  const Result<FrameView> got = sut.next_frame(0ns);
  CHECK(got.has_value());
  CHECK((got->flags & k_frame_trigger_mismatch) != 0);
  CHECK_EQUAL(1, sut.health().trigger.frames_without_edge);
}

}  // namespace
}  // namespace biteline::hal
