// SPDX-License-Identifier: MIT
// A camera that is not in the state of its calibration: no light, no profile, and the reason by name.
#include <CppUTest/TestHarness.h>

#include <array>
#include <memory>

#include "hal/linux/posix/descriptor.hpp"
#include "hal/sim/gvcamera/genicam_description.hpp"
#include "tests/integration/faults/fault_stand.hpp"
#include "tests/support/errors.hpp"

namespace biteline::test {

using geometry::StateKey;
namespace registers = sim::gv_register;

TEST_GROUP(CameraState) {
  std::unique_ptr<FaultStand> stand;

  struct Left {
    std::uint32_t address;
    std::uint32_t value, usual;
    const char* words;
  };
  static constexpr std::array k_left{
      Left{registers::k_reverse_x, 1, 0, "mirrors left to right"},
      Left{registers::k_reverse_y, 1, 0, "mirrors top to bottom"},
      Left{registers::k_binning_y, 2, 1, "binning along the columns is 2"},
      Left{registers::k_decimation_x, 2, 1, "decimation along the rows is 2"},
  };

  static PictureCellConfig calibrated() {
    PictureCellConfig config;
    config.calibrated = geometry::plain_state();
    config.calibrated[StateKey::SensorWidth] = 1626;
    config.calibrated[StateKey::SensorHeight] = 1236;
    config.calibrated.pixel_format = "Mono8";
    return config;
  }
  void refused_in_the_dark(const char* words) {
    const auto dark_since = stand->cell().dark_since();
    const auto refused = stand->start_scan();
    CHECK(refused.has_value());
    STRCMP_CONTAINS(words, refused->c_str());
    CHECK_FALSE(stand->cell().laser_on());
    CHECK(stand->cell().dark_since() == dark_since);
    LONGS_EQUAL(0, stand->account().profiles);
  }
  void scans() {
    const auto begun = stand->start_scan(5);
    CHECK_TEXT(!begun, begun.value_or("").c_str());
    stand->command(wire::Command::StopScan);
    CHECK(stand->take_end());
    LONGS_EQUAL(0, stand->account().end->errc);
  }
};

TIMED_TEST(CameraState, WhatTheCameraDoesNotLetGoOfIsRefusedByNameInTheDark) {
  stand = FaultStand::set_up(calibrated());
  if (!stand) return;
  stand->cell().lock_camera_state();
  for (const Left& left : k_left) {
    stand->cell().leave_in_camera(left.address, left.value);
    refused_in_the_dark(left.words);
    stand->cell().leave_in_camera(left.address, left.usual);
  }
  scans();
}

TIMED_TEST(CameraState, WhatAnotherProgramLeftIsSetAsCalibratedAndTheHelloTellsIt) {
  stand = FaultStand::set_up(calibrated());
  if (!stand) return;
  for (const Left& left : k_left) stand->cell().leave_in_camera(left.address, left.value);
  scans();
  DOUBLES_EQUAL(0, *stand->hello().camera_state[StateKey::MirrorX], 0);
  DOUBLES_EQUAL(1, *stand->hello().camera_state[StateKey::BinningY], 0);
  DOUBLES_EQUAL(1626, *stand->hello().model.camera_state[StateKey::SensorWidth], 0);
  STRCMP_EQUAL("Mono8", stand->hello().camera_state.pixel_format.c_str());
}

TIMED_TEST(CameraState, AnOlderCalibrationTellsNothingAndNothingIsSetForIt) {
  stand = FaultStand::set_up();
  if (!stand) return;
  for (const Left& left : k_left) {
    stand->cell().leave_in_camera(left.address, left.value);
    refused_in_the_dark("the calibration does not tell of it (camera_state");
    stand->cell().leave_in_camera(left.address, left.usual);
  }
  scans();
}

TIMED_TEST(CameraState, OneThatWasCalibratedMirroredIsRunMirrored) {
  PictureCellConfig config = calibrated();
  config.calibrated[StateKey::MirrorX] = 1;
  config.calibrated[StateKey::MirrorY] = 1;
  stand = FaultStand::set_up(config);
  if (!stand) return;
  const auto begun = stand->start_scan(0);
  CHECK_TEXT(!begun, begun.value_or("").c_str());
  DOUBLES_EQUAL(1, *stand->hello().camera_state[StateKey::MirrorX], 0);
  const auto stopped = hal::monotonic_now();
  stand->command(wire::Command::StopScan);
  CHECK(stand->take_end());
  // The scan's end and the laser's line reach this process on ways of their own.
  CHECK(stand->dark_after_ms(stopped).has_value());
  // Set back by hand and locked: then it is the other way round.
  stand->cell().lock_camera_state();
  stand->cell().leave_in_camera(registers::k_reverse_x, 0);
  refused_in_the_dark("the camera no longer mirrors left to right");
}

TIMED_TEST(CameraState, OneThatIsTurnedWithinAScanEndsItByName) {
  stand = FaultStand::set_up(calibrated());
  if (!stand) return;
  const auto begun = stand->start_scan(5);
  CHECK_TEXT(!begun, begun.value_or("").c_str());
  stand->cell().leave_in_camera(registers::k_reverse_y, 1);
  stand->command(wire::Command::StopScan);
  CHECK(stand->take_end());
  LONGS_EQUAL(static_cast<int>(Errc::Refused), stand->account().end->errc);
  STRCMP_CONTAINS("mirrors top to bottom", stand->account().end->where.c_str());
  scans();
}

}  // namespace biteline::test
