// SPDX-License-Identifier: MIT
#include "firmware/app/test_pattern.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "firmware/pipeline/profile_pipeline.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_head.hpp"

namespace biteline::sensor {
namespace {

/// A camera that sees white alone, and checks what comes back to it.
class WhiteCamera final : public hal::LineCamera {
 public:
  explicit WhiteCamera(const geometry::Region& region)
      : width_px{region.width_px},
        height_px{region.height_px},
        pixels_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), 255) {}
  int width_px, height_px;
  int lent{0};

  Result<hal::CameraLimits> limits() override { return hal::CameraLimits{}; }
  Result<hal::CameraSettings> configure(const hal::CameraSettings& wanted) override { return wanted; }
  Result<void> start() override { return {}; }
  Result<hal::FrameView> next_frame(Nanoseconds) override {
    ++lent;
    return hal::FrameView{.pixels = pixels_,
                          .width_px = width_px,
                          .height_px = height_px,
                          .stride_bytes = static_cast<std::size_t>(width_px),
                          .sequence = 41,
                          .exposure_mid = SensorClock::time_point{Nanoseconds{7}},
                          .flags = hal::k_frame_gap_before};
  }
  void release(const hal::FrameView& frame) noexcept override {
    if (frame.pixels.data() == pixels_.data()) --lent;
  }
  Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override { return exposure; }
  Result<void> stop() override { return {}; }
  hal::CameraHealth health() const noexcept override { return {.frames = 3}; }

 private:
  std::vector<std::uint8_t> pixels_;
};

}  // namespace

TEST_GROUP(TestPattern) {
  geometry::SensorModel head = test::made_head(640, 320);
  WhiteCamera* camera{nullptr};
  std::unique_ptr<TestPatternCamera> sut;

  void setup() override {
    auto white = std::make_unique<WhiteCamera>(head.region);
    camera = white.get();
    sut = std::make_unique<TestPatternCamera>(std::move(white), head.region);
  }
};

TEST(TestPattern, EachColumnsPeakIsFoundWhereThePatternHasIt) {
  auto pipeline = pipeline::ProfilePipeline::create({}, head);
  SUCCEEDS(pipeline);
  const auto frame = sut->next_frame(Nanoseconds{0});
  SUCCEEDS(frame);
  const auto made = std::make_unique<profile::ProfileBuffer>();
  CHECK(pipeline->rt_process(*frame, *made));
  LONGS_EQUAL(640, made->count);
  constexpr double k_tolerance_px = 0.05;  // 8 bits of grey
  for (const profile::ProfilePoint& point : made->view()) {
    DOUBLES_EQUAL(pattern_row_px(head.region, point.column), static_cast<double>(point.row_px),
                  k_tolerance_px);
    LONGS_EQUAL(0, point.flags);
  }
  // Out of every cloud, also of hosts that know no test pattern.
  CHECK((made->header.flags & profile::k_profile_not_usable & profile::k_profile_frame_damaged) != 0);
}

TEST(TestPattern, FramesKeepTheirStampsAndGoBackToTheCamera) {
  const auto frame = sut->next_frame(Nanoseconds{0});
  SUCCEEDS(frame);
  LONGS_EQUAL(41, frame->sequence);
  LONGS_EQUAL(7, frame->exposure_mid.time_since_epoch().count());
  LONGS_EQUAL(hal::k_frame_gap_before | hal::k_frame_damaged, frame->flags);
  LONGS_EQUAL(1, camera->lent);
  sut->release(*frame);
  LONGS_EQUAL(0, camera->lent);
  LONGS_EQUAL(3, sut->health().frames);
}

TEST(TestPattern, TheCamerasOwnPictureNeverGoesOutInItsPlace) {
  camera->height_px = 100;
  FAILS_NAMING(Errc::DeviceError, "640 x 100 instead of 640 x 320", sut->next_frame(Nanoseconds{0}));
  LONGS_EQUAL(0, camera->lent);
}

}  // namespace biteline::sensor
