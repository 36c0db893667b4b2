// SPDX-License-Identifier: MIT
#include "common/session/session.hpp"

#include <CppUTest/TestHarness.h>

#include "common/config/sensor_yaml.hpp"
#include "common/image/grey_image.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::session {

TEST_GROUP(Session) {
  test::TemporaryFolder folder;
  std::string frames = "#timestamp [ns],filename\n1000,1000.png\n2000,2000.png\n";
  std::string poses =
      "#timestamp [ns],p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z []\n"
      "900,1,2,3,1,0,0,0\n1500,4,5,6,0.6,0,0.8,0\n2100,7,8,9,1,0,0,0\n";

  Result<Session> read() {
    geometry::SensorModel sensor;
    sensor.camera.fu_px = sensor.camera.fv_px = 1000;
    sensor.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 4, .height_px = 3};
    folder.write("cam0/sensor.yaml", config::sensor_yaml_text(sensor, "made"));
    folder.write("cam0/data.csv", frames);
    folder.write("pose0/data.csv", poses);
    std::filesystem::create_directories(folder.path() / "cam0/data");
    for (const char* name : {"1000.png", "2000.png"}) {
      SUCCEEDS(image::write_png(folder.path() / "cam0/data" / name,
                                {.width_px = 4, .height_px = 3, .pixels = std::vector<std::uint8_t>(12)}));
    }
    return read_session(folder.path());
  }
};

TEST(Session, WholeFolderIsRead) {
  const auto sut = read();
  SUCCEEDS(sut);
  LONGS_EQUAL(2, sut->frames.size());
  LONGS_EQUAL(3, sut->poses.size());
  LONGS_EQUAL(2000, sut->frames[1].exposure_mid.time_since_epoch().count());
  // Rotation about y by 2 atan(0.8 / 0.6): x goes towards -z.
  const Vec3 x_base = sut->poses[1].T_base_flange.linear() * Vec3::UnitX();
  DOUBLES_EQUAL(1 - 2 * 0.8 * 0.8, x_base.x(), 1e-12);
  DOUBLES_EQUAL(-2 * 0.6 * 0.8, x_base.z(), 1e-12);
}

TEST(Session, PosesThatDoNotCoverTheFramesAreRefused) {
  poses = "900,1,2,3,1,0,0,0\n1500,4,5,6,1,0,0,0\n";
  FAILS_NAMING(Errc::BadValue, "poses do not cover frame 2000.png", read());
}

TEST(Session, StampsAtTheEndsOfTheirRangeAreRefused) {
  // Their differences would not fit the type that they are counted in.
  poses = "-9223372036854775808,1,2,3,1,0,0,0\n9223372036854775807,7,8,9,1,0,0,0\n";
  FAILS_NAMING(Errc::BadValue, "pose0/data.csv row 1, field 1: a stamp within 73 years", read());
  poses = "900,1e308,2,3,1,0,0,0\n2100,7,8,9,1,0,0,0\n";
  FAILS_NAMING(Errc::BadValue, "pose0/data.csv row 1, field 2", read());
}

TEST(Session, AnEncodersCountsBelongToTheirPoses) {
  SUCCEEDS(read());
  CHECK(!read()->poses[0].encoder_ticks);
  // A pose may have none; what stands behind the last pose is of a recording that was cut.
  folder.write("pose0/encoder.csv",
               std::string{k_encoder_table_head} + "900,-5\n2100,9007199254740992\n2200,1\n");
  const auto sut = read();
  SUCCEEDS(sut);
  CHECK(sut->poses[0].encoder_ticks == -5);
  CHECK(!sut->poses[1].encoder_ticks);
  CHECK(sut->poses[2].encoder_ticks == std::int64_t{1} << 53);
  folder.write("pose0/encoder.csv", "900,-5\n1501,7\n");
  FAILS_NAMING(Errc::BadValue, "pose0/encoder.csv row 2, field 1: rising stamps of the poses", read());
  folder.write("pose0/encoder.csv", "900,-5\n900,7\n");
  FAILS_NAMING(Errc::BadValue, "pose0/encoder.csv row 2, field 1: rising stamps of the poses", read());
  folder.write("pose0/encoder.csv", "900,9007199254740993\n");
  FAILS_NAMING(Errc::BadValue, "pose0/encoder.csv row 1, field 2: a count between", read());
  folder.write("pose0/encoder.csv", "900,1.5\n");
  FAILS_NAMING(Errc::BadValue, "pose0/encoder.csv row 1, field 2: a whole number", read());
}

TEST(Session, BadRowsAreNamed) {
  poses = "900,1,2,3,1,0,0,0\n1500,4,5,6,1,0\n2100,7,8,9,1,0,0,0\n";
  FAILS_NAMING(Errc::BadFormat, "pose0/data.csv row 2: 8 fields expected, found 6", read());
  poses = "900,1,2,3,1,0,0,0\n1500,nan,5,6,1,0,0,0\n2100,7,8,9,1,0,0,0\n";
  FAILS_NAMING(Errc::BadValue, "pose0/data.csv row 2, field 2", read());
  poses = "900,1,2,3,1,0,0,0\n1500,4,5,6,1,1,0,0\n2100,7,8,9,1,0,0,0\n";
  FAILS_NAMING(Errc::BadValue, "unit quaternion", read());
  poses = "900,1,2,3,1,0,0,0\n900,4,5,6,1,0,0,0\n2100,7,8,9,1,0,0,0\n";
  FAILS_NAMING(Errc::BadValue, "rising stamps", read());
}

TEST(Session, MissingPictureAndPathOutOfTheSessionAreRefused) {
  frames = "1000,1000.png\n2000,3000.png\n";
  FAILS_NAMING(Errc::FileNotFound, "3000.png (named in data.csv row 2)", read());
  frames = "1000,../../secret.png\n";
  FAILS_NAMING(Errc::BadValue, "row 1, field 2: a plain file name", read());
}

TEST(Session, MissingFolderIsToldOnce) {
  FAILS_NAMING(Errc::FileNotFound, "nowhere", read_session(folder.path() / "nowhere"));
}

TEST(Session, PoseTableSurvivesWriting) {
  const std::vector<StampedPose> written{
      {.stamp = RobotClock::time_point{Nanoseconds{5}},
       .T_base_flange = geometry::exp_se3((Twist() << 1, -2, 3, 0.3, 0.2, -0.9).finished())},
      {.stamp = RobotClock::time_point{Nanoseconds{9}},
       .T_base_flange = geometry::exp_se3((Twist() << 5, 2, 3, 0.1, 1.2, 0.9).finished())}};
  SUCCEEDS(write_pose_table(folder.path() / "poses.csv", written));
  const auto sut = read_pose_table(folder.path() / "poses.csv");
  SUCCEEDS(sut);
  // Six decimals of a millimetre, ten of a quaternion.
  for (std::size_t i = 0; i < 2; ++i)
    TRANSFORMS_EQUAL(written[i].T_base_flange, (*sut)[i].T_base_flange, 1e-6, 1e-9);
}

TEST(Session, NumberedPosesMayComeInAnyOrderButOnlyOnce) {
  folder.write("poses.csv",
               "#timestamp [ns],p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z "
               "[]\n4,1,2,3,1,0,0,0\n2,4,5,6,1,0,0,0\n");
  const auto sut = read_pose_table(folder.path() / "poses.csv", RowOrder::Any);
  SUCCEEDS(sut);
  LONGS_EQUAL(2, (*sut)[1].stamp.time_since_epoch().count());
  folder.write("poses.csv",
               "#timestamp [ns],p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z "
               "[]\n4,1,2,3,1,0,0,0\n4,4,5,6,1,0,0,0\n");
  FAILS_NAMING(Errc::BadValue, "field 1: a number not yet used",
               read_pose_table(folder.path() / "poses.csv", RowOrder::Any));
}

}  // namespace biteline::session
