// SPDX-License-Identifier: MIT
#include "common/geometry/camera_state.hpp"

#include <CppUTest/TestHarness.h>

#include <array>

namespace biteline::geometry {

TEST_GROUP(CameraState){static CameraState with(StateKey key, double value){CameraState state = plain_state();
state[key] = value;
return state;
}  // namespace biteline::geometry
static std::string first(const CameraState& calibrated, const CameraState& seen) {
  const auto lines = differences(calibrated, seen);
  return lines.empty() ? "" : lines.front();
}
}
;

TEST(CameraState, TheTableIsInTheOrderOfItsKeysAndHasItsUsualValuesWithinItsRanges) {
  std::size_t at = 0;
  for (const StateRow& row : state_table()) {
    LONGS_EQUAL(at++, static_cast<std::size_t>(row.key));
    if (row.usual) CHECK(row.range.holds(*row.usual));
  }
  LONGS_EQUAL(k_state_keys, at);
}

TEST(CameraState, EveryValueThatDiffersIsNamedAndNoOther) {
  for (const StateRow& row : state_table()) {
    const double one = row.is_switch ? 0 : 2, other = row.is_switch ? 1 : 3;
    const auto lines = differences(with(row.key, one), with(row.key, other));
    LONGS_EQUAL(1, lines.size());
    STRCMP_CONTAINS(row.words, lines.front().c_str());
    CHECK(differences(with(row.key, other), with(row.key, other)).empty());
  }
  STRCMP_EQUAL("the camera mirrors left to right (ReverseX, HFLIP), the calibration was made without",
               first(plain_state(), with(StateKey::MirrorX, 1)).c_str());
  STRCMP_EQUAL(
      "the camera no longer mirrors top to bottom (ReverseY, VFLIP), the calibration was made with that",
      first(with(StateKey::MirrorY, 1), plain_state()).c_str());
  STRCMP_EQUAL("the camera's binning along the rows is 2, the calibration was made with 1",
               first(plain_state(), with(StateKey::BinningX, 2)).c_str());
  CameraState grey, mono;
  grey.pixel_format = "GREY";
  mono.pixel_format = "Y10P";
  STRCMP_EQUAL("the camera's pixel format is Y10P, the calibration was made with GREY",
               first(grey, mono).c_str());
}

TEST(CameraState, ACalibrationThatTellsNothingMeansTheUsualState) {
  STRCMP_EQUAL(
      "the camera mirrors left to right (ReverseX, HFLIP), the calibration does not tell of it "
      "(camera_state, mirror_x)",
      first({}, with(StateKey::MirrorX, 1)).c_str());
  STRCMP_CONTAINS("(camera_state, turn_deg), which means 0", first({}, with(StateKey::Turn, 180)).c_str());
  CHECK(differences({}, plain_state()).empty());
  // What has no usual value cannot differ from what nobody told.
  for (const StateKey key : {StateKey::SensorWidth, StateKey::BlackLevel, StateKey::Focus, StateKey::Zoom})
    CHECK(differences({}, with(key, 7)).empty());
}

TEST(CameraState, WhatTheDeviceDoesNotTellDiffersFromNothing) {
  CHECK(differences(with(StateKey::MirrorX, 1), {}).empty());
  CHECK(expect_state(with(StateKey::BinningX, 4), {}).has_value());
  CHECK_FALSE(CameraState{}.told());
}

TEST(CameraState, SeveralAreCountedBehindTheFirst) {
  CameraState seen = with(StateKey::MirrorX, 1);
  seen[StateKey::MirrorY] = 1;
  seen[StateKey::Turn] = 90;
  const auto refused = expect_state(plain_state(), seen);
  CHECK_FALSE(refused.has_value());
  CHECK(refused.error().code == Errc::Refused);
  LONGS_EQUAL(2, refused.error().more_faults);
}

TEST(CameraState, RoundingIsNoDifferenceAndTheNextStepIs) {
  CHECK(differences(with(StateKey::BlackLevel, 4.0), with(StateKey::BlackLevel, 4.000001)).empty());
  CHECK_FALSE(differences(with(StateKey::BlackLevel, 4), with(StateKey::BlackLevel, 5)).empty());
  CHECK_FALSE(differences(with(StateKey::BlackLevel, 0), with(StateKey::BlackLevel, 1)).empty());
  CHECK_FALSE(differences(with(StateKey::SensorWidth, 1626), with(StateKey::SensorWidth, 1600)).empty());
  CHECK_FALSE(differences(with(StateKey::SensorHeight, 1236), with(StateKey::SensorHeight, 1237)).empty());
}

}  // namespace biteline::geometry
