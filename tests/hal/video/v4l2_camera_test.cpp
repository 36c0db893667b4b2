// SPDX-License-Identifier: MIT
// The V4L2 camera before drivers as real boards have them.
#include "hal/linux/v4l2/v4l2_camera.hpp"

#include <CppUTest/TestHarness.h>
#include <linux/videodev2.h>

#include <array>
#include <cerrno>

#include "tests/hal/conformance/camera.hpp"
#include "tests/hal/video/fake_video.hpp"
#include "tests/support/errors.hpp"

namespace biteline::hal {

using namespace std::chrono_literals;
using geometry::StateKey;
using test::FakeDriver;
using test::FakeVideo;

TEST_GROUP(V4l2Camera){
    static std::unique_ptr<V4l2Camera> open(const FakeVideo& node, const std::string& control = {}){
        auto camera = V4l2Camera::open({.device = node.path(), .control_device = control, .buffers = 4});
SUCCEEDS(camera);
return std::move(*camera);
}  // namespace biteline::hal
static CameraSettings part() {
  return {.region = {.offset_u_px = 32, .offset_v_px = 100, .width_px = 320, .height_px = 64}};
}
/// Pixels of the next frame that are not the sensor's own at that place.
static int wrong_pixels(V4l2Camera& camera, const geometry::Region& region) {
  const auto frame = camera.next_frame(2s);
  SUCCEEDS(frame);
  LONGS_EQUAL(0, frame->flags & ~std::uint32_t{k_frame_stamp_uncertain});
  int wrong = 0;
  for (int v = 0; v < frame->height_px; ++v) {
    for (int u = 0; u < frame->width_px; ++u) {
      const std::uint8_t expected = FakeVideo::grey(region.offset_u_px + u, region.offset_v_px + v);
      wrong +=
          frame->pixels[static_cast<std::size_t>(v) * frame->stride_bytes + static_cast<std::size_t>(u)] !=
          expected;
    }
  }
  camera.release(*frame);
  return wrong;
}
/// Whole pictures of a driver, bit for bit, of the whole sensor and of a part.
static void gives_true_pictures(const FakeDriver& driver) {
  FakeVideo node{driver};
  const auto sut = open(node);
  for (const geometry::Region& region :
       {part().region, geometry::Region{.width_px = 640, .height_px = 480}}) {
    SUCCEEDS(sut->configure({.region = region}));
    SUCCEEDS(sut->start());
    for (int i = 0; i < 6; ++i) LONGS_EQUAL(0, wrong_pixels(*sut, region));
    LONGS_EQUAL(0, sut->health().frames_damaged);
    SUCCEEDS(sut->stop());
  }
}
static std::string refusal_of(const FakeDriver& driver) {
  FakeVideo node{driver};
  auto camera = V4l2Camera::open({.device = node.path()});
  if (!camera) return camera.error().where.c_str();
  const auto taken = (*camera)->configure(part());
  if (!taken) return taken.error().where.c_str();
  const auto started = (*camera)->start();
  CHECK(!started.has_value());
  return started.error().where.c_str();
}
}
;

TEST(V4l2Camera, ConformsOverBothInterfacesOfTheKernel) {
  for (const bool in_planes : {false, true}) {
    FakeVideo node{{.in_planes = in_planes}};
    const auto sut = open(node);
    conformance::check_camera(*sut, {.settings = part()});
    conformance::check_camera_state(*sut, part());
  }
}

TEST(V4l2Camera, LosesFramesWhileAllBuffersOfAPlaneAreLentAndSaysSo) {
  FakeVideo node{{.in_planes = true}};
  const auto sut = open(node);
  conformance::check_camera_starved(*sut, {.settings = part()});
}

TEST(V4l2Camera, OnePlaneIsReadAsTheOtherInterfaceIs) {
  gives_true_pictures({.in_planes = true});
  gives_true_pictures({.formats = {"NV12", "Y10 "}, .in_planes = true});
  gives_true_pictures({.in_planes = true, .row_padding_bytes = 64, .spare_bytes = 4096});
  // A plane whose picture begins behind a header of the driver's.
  gives_true_pictures({.in_planes = true, .data_offset = 128});
}

TEST(V4l2Camera, BuffersWithMoreRoomThanAPictureHoldWholePictures) {
  gives_true_pictures({.spare_bytes = 4096});
  gives_true_pictures({.row_padding_bytes = 32, .spare_bytes = 1});
  gives_true_pictures({.formats = {"Y10 "}, .spare_bytes = 22'000});
  gives_true_pictures({.crops = true, .spare_bytes = 640});
}

TEST(V4l2Camera, APictureThatLacksARowIsDamagedHoweverLargeItsBufferIs) {
  for (const bool in_planes : {false, true}) {
    FakeVideo node{{.in_planes = in_planes, .spare_bytes = 4096, .short_bytes = 640}};
    const auto sut = open(node);
    SUCCEEDS(sut->configure(part()));
    SUCCEEDS(sut->start());
    const auto frame = sut->next_frame(2s);
    SUCCEEDS(frame);
    CHECK((frame->flags & k_frame_damaged) != 0);
    sut->release(*frame);
  }
}

TEST(V4l2Camera, WhatADriverCannotGiveIsRefusedByName) {
  STRCMP_CONTAINS("BA81, RG10: GREY, Y10P", refusal_of({.formats = {"BA81", "RG10"}}).c_str());
  STRCMP_CONTAINS("NV12: GREY", refusal_of({.formats = {"NV12"}, .in_planes = true}).c_str());
  STRCMP_CONTAINS("3 planes: one expected", refusal_of({.in_planes = true, .planes = 3}).c_str());
  STRCMP_CONTAINS("4 planes: one expected", refusal_of({.in_planes = true, .planes = 4}).c_str());
  FakeVideo node{{.formats = {"GREY"}}};
  const auto asked = V4l2Camera::open({.device = node.path(), .format = PixelFormat::Grey10In16});
  CHECK(!asked.has_value());
  STRCMP_CONTAINS("gives GREY: Y10 expected", asked.error().where.c_str());
}

TEST(V4l2Camera, AStreamThatDoesNotBeginTellsItsCauseAndTheWayOut) {
  struct Case {
    unsigned long request;
    int number;
    const char* words;
    Errc code;
  };
  constexpr std::array k_cases{
      Case{VIDIOC_STREAMON, EPIPE, "media-ctl", Errc::DeviceError},
      Case{VIDIOC_STREAMON, ENOLINK, "link of the media pipeline", Errc::DeviceError},
      Case{VIDIOC_STREAMON, ENOSPC, "bandwidth", Errc::DeviceError},
      Case{VIDIOC_STREAMON, EBUSY, "another program has it", Errc::DeviceError},
      Case{VIDIOC_REQBUFS, EBUSY, "another program has it", Errc::DeviceError},
      Case{VIDIOC_S_FMT, EBUSY, "another program has it", Errc::DeviceError},
      Case{VIDIOC_REQBUFS, ENOMEM, "cma=", Errc::DeviceError},
      Case{VIDIOC_STREAMON, ENODEV, "gone", Errc::DeviceLost},
      Case{VIDIOC_STREAMON, EINVAL, "v4l2-ctl --list-formats-ext", Errc::DeviceError},
      Case{VIDIOC_STREAMON, EREMOTEIO, "does not answer its driver", Errc::DeviceError},
      Case{VIDIOC_STREAMON, ETIMEDOUT, "does not answer its driver", Errc::DeviceError},
  };
  for (const bool in_planes : {false, true}) {
    for (const Case& each : k_cases) {
      FakeVideo node{{.in_planes = in_planes, .failing = {{each.request, each.number}}}};
      const auto sut = open(node);
      Result<void> begun = sut->configure(part()).map([](const auto&) {});
      if (begun) begun = sut->start();
      CHECK(!begun.has_value());
      STRCMP_CONTAINS(node.path().c_str(), begun.error().where.c_str());
      STRCMP_CONTAINS(each.words, begun.error().where.c_str());
      LONGS_EQUAL(each.number, begun.error().sys_errno);
      CHECK(begun.error().code == each.code);
      // Afterwards it starts as if nothing had been.
      node.driver.failing.clear();
      SUCCEEDS(sut->configure(part()));
      SUCCEEDS(sut->start());
    }
  }
}

TEST(V4l2Camera, ASizeThatAnotherProgramLeftIsNotTheSensors) {
  const FakeDriver left{.width_px = 320, .height_px = 240, .sizes = {{320, 240}, {1280, 800}, {640, 480}}};
  const geometry::Region region{.offset_u_px = 100, .offset_v_px = 240, .width_px = 640, .height_px = 320};
  FakeVideo node{left};
  const auto sut = open(node);
  LONGS_EQUAL(1280, sut->limits()->sensor_width_px);
  SUCCEEDS(sut->configure({.region = region}));
  SUCCEEDS(sut->start());
  LONGS_EQUAL(0, wrong_pixels(*sut, region));
  DOUBLES_EQUAL(1280, *(*sut->state())[StateKey::SensorWidth], 0);
  DOUBLES_EQUAL(800, *(*sut->state())[StateKey::SensorHeight], 0);
}

TEST(V4l2Camera, TheSizeOfTheCalibrationCountsWhateverWasLeftAndWhateverIsLargest) {
  for (const bool lists_range : {false, true}) {
    // A small region fits into what was left, too: it would show another part of the sensor.
    const geometry::Region region{.offset_u_px = 10, .offset_v_px = 20, .width_px = 300, .height_px = 64};
    FakeVideo node{{.width_px = 320,
                    .height_px = 240,
                    .sizes = {{320, 240}, {1280, 800}, {640, 480}},
                    .lists_range = lists_range}};
    const auto sut = open(node);
    geometry::CameraState calibrated;
    calibrated[StateKey::SensorWidth] = 640;
    calibrated[StateKey::SensorHeight] = 480;
    SUCCEEDS(sut->set_state(calibrated));
    SUCCEEDS(sut->configure({.region = region}));
    CHECK(differences(calibrated, *sut->state()).empty());
    LONGS_EQUAL(640, node.driver.width_px);
    // A size that it does not have is no error of the camera's, and differs.
    calibrated[StateKey::SensorWidth] = lists_range ? 20'000 : 800;
    const auto seen = sut->set_state(calibrated);
    SUCCEEDS(seen);
    if (!lists_range) CHECK_FALSE(differences(calibrated, *seen).empty());
  }
}

TEST(V4l2Camera, ABridgeHasTheSizeOfItsPipeline) {
  FakeVideo bridge{{.follows_pipeline = true, .width_px = 640, .height_px = 480, .lists_range = true}};
  FakeVideo sensor{{.controls = {{V4L2_CID_VFLIP, 0}}, .pad_size = {816, 616}, .pad_crop = {1632, 1232}}};
  const auto sut = open(bridge, sensor.path());
  LONGS_EQUAL(816, sut->limits()->sensor_width_px);
  const auto state = sut->state();
  SUCCEEDS(state);
  DOUBLES_EQUAL(2, *(*state)[StateKey::BinningX], 0);
  DOUBLES_EQUAL(2, *(*state)[StateKey::BinningY], 0);
  STRCMP_CONTAINS("binning along the rows is 2", differences({}, *state).front().c_str());
}

TEST(V4l2Camera, WhatAnotherProgramSetIsSetBackAndWhatStaysIsRead) {
  struct Case {
    std::uint32_t id;
    StateKey key;
    int left, calibrated;
  };
  constexpr std::array k_cases{Case{V4L2_CID_HFLIP, StateKey::MirrorX, 1, 0},
                               Case{V4L2_CID_VFLIP, StateKey::MirrorY, 1, 0},
                               Case{V4L2_CID_HFLIP, StateKey::MirrorX, 0, 1},
                               Case{V4L2_CID_ROTATE, StateKey::Turn, 180, 0},
                               Case{V4L2_CID_BRIGHTNESS, StateKey::BlackLevel, 60, 8},
                               Case{V4L2_CID_ZOOM_ABSOLUTE, StateKey::Zoom, 200, 100},
                               Case{V4L2_CID_FOCUS_ABSOLUTE, StateKey::Focus, 30, 45},
                               Case{V4L2_CID_PAN_ABSOLUTE, StateKey::Pan, 10, 0},
                               Case{V4L2_CID_IRIS_ABSOLUTE, StateKey::Aperture, 4, 5}};
  for (const Case& each : k_cases) {
    geometry::CameraState calibrated;
    calibrated[each.key] = each.calibrated;
    FakeVideo node{{.controls = {{each.id, each.left}}}};
    const auto sut = open(node);
    DOUBLES_EQUAL(each.left, *(*sut->state())[each.key], 0);
    // Told nothing, it touches nothing.
    SUCCEEDS(sut->set_state({}));
    LONGS_EQUAL(each.left, node.driver.controls.at(each.id));
    CHECK(differences(calibrated, *sut->set_state(calibrated)).empty());
    LONGS_EQUAL(each.calibrated, node.driver.controls.at(each.id));
    // Listed and refused: read, and told by name.
    node.driver.controls[each.id] = each.left;
    node.driver.stuck = {each.id};
    const auto seen = sut->set_state(calibrated);
    SUCCEEDS(seen);
    LONGS_EQUAL(1, static_cast<int>(differences(calibrated, *seen).size()));
    // Not listed: not told, and no difference.
    node.driver.controls.clear();
    CHECK_FALSE((*sut->set_state(calibrated))[each.key].has_value());
    CHECK(differences(calibrated, *sut->state()).empty());
  }
}

TEST(V4l2Camera, AFlipIsOnTheSensorsOwnDeviceWhereThereIsOne) {
  FakeVideo node{{.controls = {{V4L2_CID_HFLIP, 0}}}};
  FakeVideo sensor{{.controls = {{V4L2_CID_HFLIP, 1}}}};
  const auto sut = open(node, sensor.path());
  DOUBLES_EQUAL(1, *(*sut->state())[StateKey::MirrorX], 0);
  SUCCEEDS(sut->set_state(geometry::plain_state()));
  LONGS_EQUAL(0, sensor.driver.controls.at(V4L2_CID_HFLIP));
}

TEST(V4l2Camera, APictureTurnedByAFlipThatStayedIsTrueAgainOnceItIsSet) {
  FakeVideo node{{.controls = {{V4L2_CID_HFLIP, 1}, {V4L2_CID_VFLIP, 1}}}};
  const auto sut = open(node);
  const geometry::Region whole{.width_px = 640, .height_px = 480};
  SUCCEEDS(sut->configure({.region = whole}));
  SUCCEEDS(sut->start());
  CHECK(wrong_pixels(*sut, whole) > 100'000);
  SUCCEEDS(sut->stop());
  SUCCEEDS(sut->set_state(geometry::plain_state()));
  SUCCEEDS(sut->configure({.region = whole}));
  SUCCEEDS(sut->start());
  LONGS_EQUAL(0, wrong_pixels(*sut, whole));
}

}  // namespace biteline::hal
