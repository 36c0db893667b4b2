// SPDX-License-Identifier: MIT
#include "firmware/app/capture.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <memory>

#include "firmware/pipeline/profile_pipeline.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_head.hpp"
#include "tests/support/made_stripe.hpp"

namespace biteline::sensor {
namespace {

using std::chrono::microseconds;

/// A camera whose stripe's height goes with the exposure, and which shows the rows that it was told.
class SteeredCamera final : public hal::LineCamera {
 public:
  explicit SteeredCamera(const geometry::SensorModel& head)
      : region_{head.region}, exposure_{*head.exposure}, rows_{0, head.region.height_px} {}

  double grey_per_us{0.5};
  double row_px{100};  ///< of the stripe, in the region; below 0: none
  bool rows_adjustable{true};

  Result<hal::CameraLimits> limits() override {
    return hal::CameraLimits{.region_step_v_px = 2,
                             .exposure_min = microseconds{10},
                             .exposure_max = std::chrono::seconds{1},
                             .rows_adjustable = rows_adjustable};
  }
  Result<hal::CameraSettings> configure(const hal::CameraSettings& wanted) override { return wanted; }
  Result<void> start() override { return {}; }
  Result<hal::FrameView> next_frame(Nanoseconds) override {
    stripe::test::MadeStripe made;
    made.width_px = region_.width_px;
    made.height_px = rows_.height_px;
    made.amplitude = row_px < 0 ? 0 : grey_per_us * 1e-3 * static_cast<double>(exposure_.count());
    made.row_px = [this](int) { return row_px - rows_.first_px; };
    pixels_ = stripe::test::picture(made, random_);
    return hal::FrameView{.pixels = pixels_,
                          .width_px = region_.width_px,
                          .height_px = rows_.height_px,
                          .first_row_px = rows_.first_px,
                          .stride_bytes = static_cast<std::size_t>(region_.width_px),
                          .sequence = sequence_++,
                          .exposure_mid = {},
                          .flags = 0};
  }
  void release(const hal::FrameView&) noexcept override {}
  Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override { return exposure_ = exposure; }
  Result<hal::RowRange> adjust_rows(const hal::RowRange& rows) override { return rows_ = rows; }
  Result<void> stop() override { return {}; }
  hal::CameraHealth health() const noexcept override { return {}; }

  [[nodiscard]] Nanoseconds exposure() const { return exposure_; }
  [[nodiscard]] hal::RowRange rows() const { return rows_; }

 private:
  geometry::Region region_;
  Nanoseconds exposure_;
  hal::RowRange rows_;
  std::mt19937_64 random_{3};
  std::vector<std::uint8_t> pixels_;
  std::uint64_t sequence_{0};
};

geometry::SensorModel live_head() {
  geometry::SensorModel head = test::made_head(320, 256);
  head.exposure = microseconds{100};
  head.rate_hz = 100;
  return head;
}

}  // namespace

TEST_GROUP(CaptureControl) {
  geometry::SensorModel head = live_head();
  SteeredCamera camera{head};
  std::unique_ptr<profile::ProfileBuffer> profile = std::make_unique<profile::ProfileBuffer>();

  std::unique_ptr<CaptureControl> control(const Capture& capture) {
    auto made = CaptureControl::create(capture, head, camera);
    SUCCEEDS(made);
    return std::move(*made);
  }
  void take_profiles(CaptureControl & sut, int count) {
    auto pipeline = pipeline::ProfilePipeline::create({}, head);
    SUCCEEDS(pipeline);
    for (int i = 0; i < count; ++i) {
      CHECK(pipeline->rt_process(*camera.next_frame({}), *profile));
      SUCCEEDS(sut.apply(sut.rt_consider(*profile), camera));
    }
  }
  float amplitude() const {
    return profile->points[160].amplitude;
  }
};

TEST(CaptureControl, ExposureRisesOnBlackLeatherAndFallsOnWhiteFoam) {
  const auto sut = control({.auto_exposure = true});
  for (const double grey_per_us : {0.1, 2.0, 0.4}) {
    camera.grey_per_us = grey_per_us;
    take_profiles(*sut, 60);
    CHECK_COMPARE(amplitude(), >, 110.0F);
    CHECK_COMPARE(amplitude(), <, 200.0F);
    LONGS_EQUAL(camera.exposure().count(), sut->state().exposure.count());
  }
  CHECK(sut->state().exposure_changes >= 6);
}

TEST(CaptureControl, WithoutSurfaceTheExposureStaysWithinTheFramesPeriod) {
  camera.row_px = -1;
  head.rate_hz = 1000;
  const auto sut = control({.auto_exposure = true});
  take_profiles(*sut, 60);
  CHECK(camera.exposure() > microseconds{100});
  CHECK(camera.exposure() <= microseconds{900});
  // The light lasts as long as any exposure.
  CHECK(longest_exposure({.auto_exposure = true}, head) >= camera.exposure());
}

TEST(CaptureControl, RowsCloseOnTheStripeFollowItAndOpenWhenItIsLost) {
  const auto sut = control({.follow_stripe = true});
  take_profiles(*sut, 3);
  LONGS_EQUAL(camera.rows().height_px, sut->state().rows_px);
  CHECK(camera.rows().height_px <= 100);
  CHECK(sut->state().rate_max_hz > 150);
  for (int i = 0; i < 120; ++i) {
    camera.row_px = 100 + i;  // a row per profile
    take_profiles(*sut, 1);
    CHECK((profile->header.flags & profile::k_profile_stripe_lost) == 0);
    // A point's row is the sensor's, whatever the camera shows of it.
    DOUBLES_EQUAL(camera.row_px + head.region.offset_v_px, profile->points[160].row_px, 0.2);
  }
  CHECK(sut->state().row_changes >= 3);
  camera.row_px = -1;
  take_profiles(*sut, 10);
  LONGS_EQUAL(256, camera.rows().height_px);
  CHECK(sut->state().searching);
  camera.row_px = 30;
  take_profiles(*sut, 3);
  CHECK(camera.rows().height_px <= 100 && camera.rows().first_px < 30);
  CHECK(!sut->state().searching);
}

TEST(CaptureControl, ACameraThatCannotIsRefused) {
  camera.rows_adjustable = false;
  const auto refused = CaptureControl::create({.follow_stripe = true}, head, camera);
  CHECK(!refused.has_value());
  CHECK(refused.error().code == Errc::NotSupported);
  CHECK(CaptureControl::create({}, head, camera).has_value());
}

TEST(CaptureControl, WhatExcludesEachOtherIsRefused) {
  CHECK(check({}, head).has_value());
  CHECK(check({.second_exposure = microseconds{400}}, head).has_value());
  CHECK(!check({.second_exposure = microseconds{50}}, head));     // shorter than the first
  CHECK(!check({.second_exposure = microseconds{20000}}, head));  // longer than a frame's period
  CHECK(!check({.laser_off_frames = true, .second_exposure = microseconds{400}}, head));
  CHECK(!check({.auto_exposure = true, .laser_off_frames = true}, head));
  CHECK(!check({.auto_exposure = true, .second_exposure = microseconds{400}}, head));
}

}  // namespace biteline::sensor
