// SPDX-License-Identifier: MIT
// What the sensor program says of a V4L2 camera before a scan: the check starts the stream, and a scan's
// camera must be in the state of its calibration.
#include "firmware/app/board_check.hpp"

#include <CppUTest/TestHarness.h>
#include <linux/videodev2.h>

#include <array>
#include <cerrno>

#include "common/config/sensor_yaml.hpp"
#include "firmware/app/board_devices.hpp"
#include "tests/hal/video/fake_video.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_head.hpp"

namespace biteline::sensor {

using geometry::StateKey;
using test::FakeDriver;
using test::FakeVideo;

TEST_GROUP(VideoBoard) {
  test::TemporaryFolder folder;

  std::filesystem::path board_of(const FakeVideo& node) const {
    return folder.write("board.yaml",
                        "board: made\ncamera: {kind: v4l2, device: " + node.path() +
                            "}\nposes: {kind: can, interface: none0}\nwatchdog: {timeout_ms: 500}\n");
  }
  std::filesystem::path head_file(const geometry::CameraState& state) const {
    geometry::SensorModel head = test::made_head(320, 64);
    head.region = {.offset_u_px = 32, .offset_v_px = 100, .width_px = 320, .height_px = 64};
    head.rate_hz = 100;
    head.exposure = Nanoseconds{400'000};
    head.camera_state = state;
    return folder.write("sensor.yaml", config::sensor_yaml_text(head, "made"));
  }
  DeviceFinding camera_of(const FakeVideo& node, const std::optional<std::filesystem::path>& head = {})
      const {
    const auto found =
        check_board(board_of(node), {.source = "board:x", .sensor_file = head, .capture = {}, .set = {}});
    SUCCEEDS(found);
    for (const DeviceFinding& each : *found)
      if (each.what.starts_with("camera (")) return each;
    FAIL("no row of the camera");
    return {};
  }
  Result<void> scan_begins(const FakeVideo& node, const std::filesystem::path& head) const {
    auto kind = open_board(board_of(node), head, std::nullopt);
    SUCCEEDS(kind);
    // The camera comes first: what follows lacks its devices here.
    const auto source = (*kind)->open();
    CHECK(!source.has_value());
    return tl::unexpected<Error>{source.error()};
  }
};

TEST(VideoBoard, CheckTakesFramesOfACameraThatStreams) {
  for (const bool in_planes : {false, true}) {
    const FakeVideo node{{.in_planes = in_planes, .spare_bytes = 4096}};
    const DeviceFinding found = camera_of(node);
    CHECK_TEXT(found.ready, found.seen.c_str());
    STRCMP_EQUAL("answers: 3 frames of 640 x 480", found.seen.c_str());
    STRCMP_EQUAL("", found.step.c_str());
  }
}

TEST(VideoBoard, CheckFindsWhatOnlyARunningStreamTells) {
  struct Case {
    FakeDriver driver;
    const char *words, *step;
  };
  const std::array cases{
      Case{{.failing = {{VIDIOC_STREAMON, EPIPE}}}, "media-ctl", "mend what it says"},
      Case{{.failing = {{VIDIOC_STREAMON, ENOSPC}}}, "bandwidth", "mend what it says"},
      Case{{.failing = {{VIDIOC_REQBUFS, EBUSY}}}, "another program has it", "mend what it says"},
      Case{{.formats = {"BA81"}}, "BA81", "monochrome"},
      Case{{.in_planes = true, .planes = 2}, "2 planes", "monochrome"},
      Case{{.short_bytes = 640}, "every frame of 640 x 480 comes damaged", "mend what it says"},
      Case{{.failing = {{VIDIOC_STREAMON, ENODEV}}}, "gone", "cable"},
      Case{{.failing = {{VIDIOC_DQBUF, EIO}}}, "dequeue", "cable"},
  };
  for (const Case& each : cases) {
    const FakeVideo node{each.driver};
    const DeviceFinding found = camera_of(node);
    CHECK_FALSE(found.ready);
    STRCMP_CONTAINS(each.words, found.seen.c_str());
    STRCMP_CONTAINS(each.step, found.step.c_str());
  }
}

TEST(VideoBoard, CheckWithAHeadTakesItsRegionAndComparesItsState) {
  FakeVideo node{{.controls = {{V4L2_CID_HFLIP, 1}}}};
  geometry::CameraState calibrated = geometry::plain_state();
  const DeviceFinding set = camera_of(node, head_file(calibrated));
  CHECK_TEXT(set.ready, set.seen.c_str());
  STRCMP_CONTAINS("320 x 64", set.seen.c_str());
  node.driver.controls[V4L2_CID_HFLIP] = 1;
  node.driver.stuck = {V4L2_CID_HFLIP};
  const DeviceFinding stuck = camera_of(node, head_file(calibrated));
  CHECK_FALSE(stuck.ready);
  STRCMP_CONTAINS("mirrors left to right", stuck.seen.c_str());
  STRCMP_CONTAINS("calibrate it as it is", stuck.step.c_str());
}

TEST(VideoBoard, AScanOfACameraInAnotherStateDoesNotBegin) {
  geometry::CameraState calibrated = geometry::plain_state();
  calibrated[StateKey::SensorWidth] = 640;
  calibrated[StateKey::SensorHeight] = 480;
  calibrated[StateKey::BlackLevel] = 8;
  calibrated.pixel_format = "GREY";
  struct Case {
    FakeDriver driver;
    const char* words;
  };
  const std::array cases{
      Case{{.controls = {{V4L2_CID_HFLIP, 1}}, .stuck = {V4L2_CID_HFLIP}}, "mirrors left to right"},
      Case{{.controls = {{V4L2_CID_VFLIP, 1}}, .stuck = {V4L2_CID_VFLIP}}, "mirrors top to bottom"},
      Case{{.controls = {{V4L2_CID_ROTATE, 180}}, .stuck = {V4L2_CID_ROTATE}}, "turn in degrees is 180"},
      Case{{.controls = {{V4L2_CID_BRIGHTNESS, 30}}, .stuck = {V4L2_CID_BRIGHTNESS}}, "black level is 30"},
      Case{{.width_px = 1280, .height_px = 800, .sizes = {{1280, 800}}}, "full width in pixels is 1280"},
      Case{{.formats = {"Y10 "}}, "pixel format is Y10"},
  };
  for (const Case& each : cases) {
    const FakeVideo node{each.driver};
    const auto begun = scan_begins(node, head_file(calibrated));
    CHECK(begun.error().code == Errc::Refused);
    STRCMP_CONTAINS(each.words, begun.error().where.c_str());
  }
  // An older calibration: the usual is expected, and nothing is set.
  const FakeVideo left{{.controls = {{V4L2_CID_VFLIP, 1}}}};
  const auto begun = scan_begins(left, head_file({}));
  CHECK(begun.error().code == Errc::Refused);
  STRCMP_CONTAINS("(camera_state, mirror_y)", begun.error().where.c_str());
  LONGS_EQUAL(1, left.driver.controls.at(V4L2_CID_VFLIP));
  // As calibrated it goes on, to the poses, which are not there.
  const FakeVideo good{{.controls = {{V4L2_CID_VFLIP, 1}, {V4L2_CID_BRIGHTNESS, 30}}}};
  CHECK(scan_begins(good, head_file(calibrated)).error().code != Errc::Refused);
  LONGS_EQUAL(0, good.driver.controls.at(V4L2_CID_VFLIP));
  LONGS_EQUAL(8, good.driver.controls.at(V4L2_CID_BRIGHTNESS));
}

}  // namespace biteline::sensor
