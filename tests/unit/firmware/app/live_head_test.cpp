// SPDX-License-Identifier: MIT
#include "firmware/app/live_head.hpp"

#include <CppUTest/TestHarness.h>

#include <vector>

#include "common/config/sensor_yaml.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_head.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::sensor {
namespace {

using std::chrono::microseconds;

/// A camera that keeps what it was told, and fails in the middle where it is told to.
class ObstinateCamera final : public hal::LineCamera {
 public:
  enum class Fault { None, AfterRegion, TakesOtherExposure, TakesOtherGain, TakesOtherRegion };

  Fault fault{Fault::None};
  double rate_max_hz{0};
  int told{0};  ///< how often
  hal::CameraSettings now{};

  Result<hal::CameraLimits> limits() override {
    return hal::CameraLimits{.sensor_width_px = 640,
                             .sensor_height_px = 480,
                             .region_step_u_px = 4,
                             .region_step_v_px = 2,
                             .exposure_min = microseconds{10},
                             .exposure_max = microseconds{9000},
                             .gain_min = 0,
                             .gain_max = 24,
                             .gain = now.gain,
                             .rate_max_hz = rate_max_hz};
  }
  Result<hal::CameraSettings> configure(const hal::CameraSettings& wanted) override {
    ++told;
    now.region = wanted.region;
    // None in the settings: the gain stays as it is.
    now.gain = wanted.gain ? wanted.gain : now.gain;
    const Fault present = std::exchange(fault, Fault::None);
    if (present == Fault::AfterRegion) return fail(Errc::DeviceError, "camera: exposure");
    const std::optional<double> gain = now.gain;
    now = wanted;
    now.gain = gain;
    if (present == Fault::TakesOtherExposure) now.exposure = microseconds{77};
    if (present == Fault::TakesOtherGain) now.gain = 24;
    if (present == Fault::TakesOtherRegion) now.region.height_px -= 2;
    return now;
  }
  Result<void> start() override { return {}; }
  Result<hal::FrameView> next_frame(Nanoseconds) override { return fail(Errc::Timeout, "none"); }
  void release(const hal::FrameView&) noexcept override {}
  Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override { return exposure; }
  Result<void> stop() override { return {}; }
  hal::CameraHealth health() const noexcept override { return {}; }
};

geometry::SensorModel head() {
  geometry::SensorModel made = test::made_head(640, 480);
  made.exposure = microseconds{100};
  made.rate_hz = 100;
  made.region.offset_u_px = made.region.offset_v_px = 0;
  return made;
}

}  // namespace

TEST_GROUP(LiveHead) {
  ObstinateCamera camera;
  test::TemporaryFolder folder;
  static constexpr double k_gain_before = 2;
  hal::CameraSettings former{};
  Capture capture;

  void setup() override {
    former = live_settings(head(), {}, hal::Trigger::Hardware, std::nullopt).camera;
    camera.now = former;
    camera.now.gain = k_gain_before;
  }

  /// The whole way: read, put over the head, told to the camera, read back.
  Result<hal::CameraSettings> use(const std::string& body) {
    BITELINE_ASSIGN(settings::SettingsSet set, settings::parse_settings(body + "\n...\n", "set.yaml"));
    const auto file = folder.write("sensor.yaml", config::sensor_yaml_text(head(), "made"));
    BITELINE_ASSIGN(const geometry::SensorModel live, read_live_head(file, set));
    capture = put_over({}, set);
    return configure_camera(camera, live_settings(live, capture, hal::Trigger::Hardware, set), former);
  }
  void check_untouched() {
    CHECK(camera.now.exposure == former.exposure);
    DOUBLES_EQUAL(k_gain_before, *camera.now.gain, 0);
    LONGS_EQUAL(former.region.height_px, camera.now.region.height_px);
    LONGS_EQUAL(former.region.offset_v_px, camera.now.region.offset_v_px);
  }
  void refused_before_it_is_told(const char* words, const std::string& body) {
    FAILS_NAMING(Errc::BadValue, words, use(body));
    LONGS_EQUAL(0, camera.told);
    check_untouched();
  }
  void put_back_after(ObstinateCamera::Fault fault, Errc code, const char* words) {
    camera.fault = fault;
    FAILS_NAMING(code, words,
                 use("camera: {exposure_us: 400, gain: 6}\nregion: {left_px: 0, top_px: 40, width_px: 640, "
                     "height_px: 200}"));
    LONGS_EQUAL(2, camera.told);
    check_untouched();
  }
};

TEST(LiveHead, ASetStandsOverTheHeadAndIsReadBack) {
  const auto taken =
      use("camera: {exposure_us: 400, gain: 6, rate_hz: 50, follow_stripe: false}\nregion: {left_px: 4, "
          "top_px: 40, "
          "width_px: 632, height_px: 200}");
  SUCCEEDS(taken);
  LONGS_EQUAL(400'000, taken->exposure.count());
  DOUBLES_EQUAL(6, *taken->gain, 0);
  DOUBLES_EQUAL(50, taken->rate_hz, 0);
  LONGS_EQUAL(200, camera.now.region.height_px);
}

TEST(LiveHead, WhatTheCameraDoesNotTakeIsToldByLineKeyAndRangeAndNothingIsTouched) {
  refused_before_it_is_told("set.yaml line 2, camera.exposure_us: 10 to 9000 us expected, found 9500 us",
                            "camera:\n  exposure_us: 9500");
  refused_before_it_is_told("camera.gain: 0 to 24 expected, found 30",
                            "camera: {exposure_us: 400, gain: 30}");
  refused_before_it_is_told("region.height_px: at most 380 px there expected, found 400 px",
                            "region: {left_px: 0, top_px: 100, width_px: 640, height_px: 400}");
  refused_before_it_is_told("region.left_px: px in steps of 4 expected, found 2 px",
                            "region: {left_px: 2, top_px: 100, width_px: 600, height_px: 300}");
  refused_before_it_is_told("camera.rate_hz", "camera: {exposure_us: 9000, rate_hz: 200}");
  refused_before_it_is_told("camera.laser_off_frames", "camera: {laser_off_frames: on}");
  refused_before_it_is_told("camera.second_exposure_us", "camera: {second_exposure_us: 800}");
  refused_before_it_is_told("camera.follow_stripe", "camera: {follow_stripe: on}");
}

TEST(LiveHead, AFailureInTheMiddlePutsBack) {
  using Fault = ObstinateCamera::Fault;
  put_back_after(Fault::AfterRegion, Errc::DeviceError, "camera: exposure");
  camera.told = 0;
  put_back_after(Fault::TakesOtherExposure, Errc::BadValue, "camera.exposure_us: what the camera takes");
  camera.told = 0;
  put_back_after(Fault::TakesOtherGain, Errc::BadValue, "camera.gain: what the camera takes");
  camera.told = 0;
  put_back_after(Fault::TakesOtherRegion, Errc::DeviceError, "instead of");
}

TEST(LiveHead, ARateThatTheRegionDoesNotGiveIsPutBack) {
  camera.rate_max_hz = 60;
  FAILS_NAMING(Errc::BadValue, "camera.rate_hz: 0 to 60 Hz at this region and exposure expected, found 80 Hz",
               use("camera: {exposure_us: 400, rate_hz: 80}"));
  check_untouched();
}

TEST(LiveHead, ARateAtWhichTheLaserCannotStayOnIsRefused) {
  const auto checked = [](double rate_hz, const hal::Board& board) {
    geometry::SensorModel slow = head();
    slow.rate_hz = rate_hz;
    return check_lit_rate(live_settings(slow, {}, hal::Trigger::Hardware, std::nullopt), board);
  };
  hal::Board board;
  SUCCEEDS(checked(1, board));
  board.laser.emplace();
  FAILS_NAMING(Errc::BadValue, "camera.rate_hz: 20 Hz or more (the laser goes dark after 75 ms",
               checked(15, board));
  FAILS_NAMING(Errc::BadValue, "camera.rate_hz", checked(19.9, board));
  SUCCEEDS(checked(20, board));
  board.laser->patience = std::chrono::seconds{10};
  SUCCEEDS(checked(1, board));
  board.laser->patience.reset();
  board.trigger.kind = hal::BoardTrigger::Kind::Encoder;
  SUCCEEDS(checked(1, board));
}

TEST(LiveHead, ASensorYamlWithoutRateIsCompletedByASet) {
  geometry::SensorModel bare = head();
  bare.rate_hz.reset();
  bare.exposure.reset();
  const auto file = folder.write("bare.yaml", config::sensor_yaml_text(bare, "calibrated"));
  FAILS_NAMING(Errc::BadValue, "or as rate_hz and exposure_us in --settings",
               read_live_head(file, std::nullopt));
  const auto set = settings::parse_settings("camera: {exposure_us: 400, rate_hz: 50}\n...\n", "set.yaml");
  SUCCEEDS(set);
  const auto live = read_live_head(file, *set);
  SUCCEEDS(live);
  DOUBLES_EQUAL(50, *live->rate_hz, 0);
}

TEST(LiveHead, TheSetInUseIsASetAgain) {
  const auto taken = use("camera: {exposure_us: 400, gain: 6}");
  SUCCEEDS(taken);
  const auto again =
      settings::parse_settings(settings::settings_text(set_in_use(*taken, head(), capture)), "used.yaml");
  SUCCEEDS(again);
  DOUBLES_EQUAL(400, *again->number(settings::Key::ExposureUs), 0);
  DOUBLES_EQUAL(6, *again->number(settings::Key::Gain), 0);
  DOUBLES_EQUAL(480, *again->number(settings::Key::RegionHeight), 0);
}

}  // namespace biteline::sensor
