// SPDX-License-Identifier: MIT
/// \file What another program left in a network camera: set back, read, and seen in the pictures.
#include <CppUTest/TestHarness.h>

#include <array>

#include "hal/sim/gvcamera/genicam_description.hpp"
#include "tests/hal/aravis/small_camera.hpp"
#include "tests/hal/conformance/camera.hpp"
#include "tests/support/errors.hpp"

namespace biteline::hal {
namespace {

using geometry::StateKey;
namespace registers = sim::gv_register;

std::uint8_t grey(int u_px, int v_px) {
  return static_cast<std::uint8_t>(10 + (u_px / 8 + v_px / 4) % 120);
}

void paint_sensor(const GvExposure& exposure, std::span<std::uint8_t> pixels) {
  const geometry::Region& region = exposure.region;
  for (int v = 0; v < region.height_px; ++v) {
    for (int u = 0; u < region.width_px; ++u) {
      pixels[static_cast<std::size_t>(v) * static_cast<std::size_t>(region.width_px) +
             static_cast<std::size_t>(u)] = grey(region.offset_u_px + u, region.offset_v_px + v);
    }
  }
}

/// Of the next whole frame: pixels that are not the sensor's own at that place.
int wrong_pixels(AravisCamera& camera, const geometry::Region& region) {
  for (int attempt = 0; attempt < 20; ++attempt) {
    const auto frame = camera.next_frame(k_second);
    SUCCEEDS(frame);
    int wrong = 0;
    for (int v = 0; v < region.height_px; ++v) {
      for (int u = 0; u < region.width_px; ++u) {
        wrong +=
            frame->pixels[static_cast<std::size_t>(v) * frame->stride_bytes + static_cast<std::size_t>(u)] !=
            grey(region.offset_u_px + u, region.offset_v_px + v);
      }
    }
    const bool whole = (frame->flags & k_frame_damaged) == 0;
    camera.release(*frame);
    if (whole) return wrong;
  }
  FAIL("no whole frame came");
  return 0;
}

struct Left {
  std::uint32_t address;
  StateKey key;
  std::uint32_t value;
  const char* words;
};
constexpr std::array k_left{
    Left{registers::k_reverse_x, StateKey::MirrorX, 1, "mirrors left to right (ReverseX, HFLIP)"},
    Left{registers::k_reverse_y, StateKey::MirrorY, 1, "mirrors top to bottom (ReverseY, VFLIP)"},
    Left{registers::k_binning_x, StateKey::BinningX, 2, "binning along the rows is 2"},
    Left{registers::k_binning_y, StateKey::BinningY, 2, "binning along the columns is 2"},
    Left{registers::k_decimation_x, StateKey::DecimationX, 2, "decimation along the rows is 2"},
    Left{registers::k_decimation_y, StateKey::DecimationY, 2, "decimation along the columns is 2"},
    Left{registers::k_black_level, StateKey::BlackLevel, 20, "black level is 20"}};

/// As a calibration of this camera would have it.
geometry::CameraState calibrated() {
  geometry::CameraState state = geometry::plain_state();
  state[StateKey::BlackLevel] = 0;
  state[StateKey::SensorWidth] = 1626;
  state[StateKey::SensorHeight] = 1236;
  state.pixel_format = "Mono8";
  return state;
}

}  // namespace

TEST_GROUP(AravisState){};

TEST(AravisState, Conforms) {
  SERVER_OR_SKIP(server, small_camera());
  const auto sut = *AravisCamera::open({});
  conformance::check_camera_state(*sut, settings(50));
  CHECK(geometry::contradictions(calibrated(), *sut->state()).empty());
}

TEST(AravisState, WhatAnotherProgramLeftIsSetBackAndThePictureIsTrueAgain) {
  SERVER_OR_SKIP(server, small_camera(), paint_sensor);
  for (const Left& left : k_left) {
    server->leave(left.address, left.value);
    const auto sut = *AravisCamera::open({});
    // Told nothing, it leaves it; then the picture is another one.
    const auto seen = sut->set_state({});
    SUCCEEDS(seen);
    const auto lines = geometry::differences(calibrated(), *seen);
    CHECK_FALSE(lines.empty());
    STRCMP_CONTAINS(left.words, lines.front().c_str());
    CameraSettings asked = settings(50);
    asked.region = {.offset_u_px = 16, .offset_v_px = 100, .width_px = 480, .height_px = 120};
    const geometry::Region region = asked.region;
    SUCCEEDS(sut->configure(asked));
    SUCCEEDS(sut->start());
    CHECK(wrong_pixels(*sut, region) > 1000);
    SUCCEEDS(sut->stop());
    CHECK(geometry::differences(calibrated(), *sut->set_state(calibrated())).empty());
    SUCCEEDS(sut->configure(asked));
    SUCCEEDS(sut->start());
    LONGS_EQUAL(0, wrong_pixels(*sut, region));
    CHECK(geometry::differences(calibrated(), *sut->state()).empty());
    SUCCEEDS(sut->stop());
  }
}

TEST(AravisState, WhatTheCameraListsAndRefusesIsReadAndTold) {
  SERVER_OR_SKIP(server, small_camera());
  server->lock_state();
  for (const Left& left : k_left) {
    server->leave(left.address, left.value);
    const auto sut = *AravisCamera::open({});
    const auto seen = sut->set_state(calibrated());
    SUCCEEDS(seen);
    const auto lines = geometry::differences(calibrated(), *seen);
    CHECK_FALSE(lines.empty());
    STRCMP_CONTAINS(left.words, lines.front().c_str());
    const bool is_factor =
        left.key != StateKey::MirrorX && left.key != StateKey::MirrorY && left.key != StateKey::BlackLevel;
    server->leave(left.address, is_factor ? 1 : 0);
  }
}

TEST(AravisState, ABinnedSensorIsCountedInItsOwnPixels) {
  SERVER_OR_SKIP(server, small_camera());
  server->leave(registers::k_binning_x, 2);
  server->leave(registers::k_binning_y, 2);
  const auto sut = *AravisCamera::open({});
  LONGS_EQUAL(813, sut->limits()->sensor_width_px);
  LONGS_EQUAL(618, sut->limits()->sensor_height_px);
  CameraSettings beyond = settings(50);
  beyond.region = {.offset_u_px = 0, .offset_v_px = 600, .width_px = 640, .height_px = 120};
  CHECK(sut->configure(beyond).error().code == Errc::BadValue);
  SUCCEEDS(sut->set_state(geometry::plain_state()));
  LONGS_EQUAL(1626, sut->limits()->sensor_width_px);
  SUCCEEDS(sut->configure(beyond));
}

}  // namespace biteline::hal
