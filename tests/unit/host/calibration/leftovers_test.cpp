// SPDX-License-Identifier: MIT
#include "host/calibration/head/leftovers.hpp"

#include <CppUTest/TestHarness.h>

#include "common/session/session.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::calibration {

TEST_GROUP(Leftovers) {
  test::TemporaryFolder folder;

  void write(std::initializer_list<const char*> names) const {
    for (const char* name : names) folder.write(name, "");
  }
};

TEST(Leftovers, WholeFolderHasNone) {
  write({"camera/0.png", "camera/1.png", "laser/target.yaml", "laser/3_rings.png", "laser/3_laser.png",
         "handeye/5.png"});
  folder.write("handeye/poses.csv", std::string{session::k_pose_table_head} + "5,1,2,3,1,0,0,0\n");
  LONGS_EQUAL(0, camera_leftovers(folder.path()).size());
  LONGS_EQUAL(0, laser_leftovers(folder.path()).size());
  LONGS_EQUAL(0, hand_eye_leftovers(folder.path()).size());
}

TEST(Leftovers, PicturesOfThePairAreMissedBothWays) {
  write({"laser/target.yaml", "laser/3_rings.png", "laser/4_laser.png", "laser/4.png"});
  const auto lines = laser_leftovers(folder.path());
  LONGS_EQUAL(3, lines.size());
  STRCMP_EQUAL("laser/3_rings.png is not used: no picture 3_laser.png beside it", lines[0].c_str());
  STRCMP_EQUAL("laser/4_laser.png is not used: no picture 4_rings.png beside it", lines[1].c_str());
  STRCMP_CONTAINS("laser/4.png is not used", lines[2].c_str());
}

TEST(Leftovers, PoseWithoutItsPictureIsNamed) {
  write({"handeye/5.png"});
  folder.write("handeye/poses.csv",
               std::string{session::k_pose_table_head} + "5,1,2,3,1,0,0,0\n6,1,2,3,1,0,0,0\n");
  const auto lines = hand_eye_leftovers(folder.path());
  LONGS_EQUAL(1, lines.size());
  STRCMP_CONTAINS("the pose of 6 is not used", lines[0].c_str());
}

TEST(Leftovers, FolderThatIsNotThereHasNone) {
  LONGS_EQUAL(0, camera_leftovers(folder.path() / "none").size());
}

}  // namespace biteline::calibration
