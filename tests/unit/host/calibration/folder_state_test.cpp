// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include "common/config/camera_state_yaml.hpp"
#include "common/config/sensor_yaml.hpp"
#include "host/calibration/head/camera_state.hpp"
#include "host/calibration/head/leftovers.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_head.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::calibration {

using geometry::StateKey;

TEST_GROUP(FolderState) {
  test::TemporaryFolder folder;
  geometry::CameraState state = geometry::plain_state();

  void write(const std::string& part, const geometry::CameraState& of) const {
    folder.write(part + "/camera_state.yaml", config::camera_state_text(of, ""));
  }
};

TEST(FolderState, FoldersOfBeforeTellNothing) {
  folder.write("camera/0.png", "");
  const auto sut = read_folder_state(folder.path());
  SUCCEEDS(sut);
  CHECK_FALSE(sut->told());
  SUCCEEDS(expect_folder_state(folder.path(), state));
}

TEST(FolderState, PartsOfOneStateAreOneAndTheirFilesAreNoLeftovers) {
  state[StateKey::SensorWidth] = 1626;
  state.pixel_format = "GREY";
  write("camera", state);
  write("handeye", state);
  state[StateKey::BlackLevel] = 7.25;
  write("laser", state);
  const auto sut = read_folder_state(folder.path());
  SUCCEEDS(sut);
  CHECK(state == *sut);
  SUCCEEDS(expect_folder_state(folder.path(), state));
  CHECK(camera_leftovers(folder.path()).empty());
  CHECK(laser_leftovers(folder.path()).empty());
}

TEST(FolderState, PartsOfTwoStatesAreRefusedByName) {
  state[StateKey::SensorHeight] = 1236;
  state.pixel_format = "GREY";
  write("camera", state);
  for (const geometry::StateRow& row : geometry::state_table()) {
    geometry::CameraState other = state;
    if (!other[row.key]) continue;
    *other[row.key] += 1;
    for (const char* part : {"laser", "handeye"}) {
      write(part, other);
      FAILS_NAMING(Errc::Refused, row.name, read_folder_state(folder.path()));
      FAILS_NAMING(Errc::Refused, part, read_folder_state(folder.path()));
      std::filesystem::remove(folder.path() / part / "camera_state.yaml");
    }
    FAILS_NAMING(Errc::Refused, row.name, expect_folder_state(folder.path(), other));
  }
  geometry::CameraState other = state;
  other.pixel_format = "Y10P";
  FAILS_NAMING(Errc::Refused, "GREY against Y10P", expect_folder_state(folder.path(), other));
}

TEST(FolderState, AScanOfAnotherStateDoesNotBelongToThePictures) {
  geometry::SensorModel head = test::made_head(320, 200);
  SUCCEEDS(expect_scan_state(folder.path() / "clock", state));
  head.camera_state = state;
  folder.write("clock/cam0/sensor.yaml", config::sensor_yaml_text(head, "made"));
  SUCCEEDS(expect_scan_state(folder.path() / "clock", state));
  head.camera_state[StateKey::MirrorX] = 1;
  folder.write("clock/cam0/sensor.yaml", config::sensor_yaml_text(head, "made"));
  FAILS_NAMING(Errc::Refused, "mirror_x 0 against 1", expect_scan_state(folder.path() / "clock", state));
  FAILS_NAMING(Errc::Refused, "clock", expect_scan_state(folder.path() / "clock", state));
  SUCCEEDS(expect_scan_state(folder.path() / "clock", {}));
}

TEST(FolderState, AFileThatIsNoneIsTold) {
  folder.write("laser/camera_state.yaml", "mirror_x: perhaps\n");
  FAILS_NAMING(Errc::BadValue, "mirror_x", read_folder_state(folder.path()));
}

}  // namespace biteline::calibration
