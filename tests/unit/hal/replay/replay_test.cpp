// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <fstream>

#include "common/config/sensor_yaml.hpp"
#include "common/image/grey_image.hpp"
#include "hal/replay/recording.hpp"
#include "hal/replay/replay_camera.hpp"
#include "hal/replay/replay_poses.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_session.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::hal::replay {
namespace {

using std::chrono::seconds;

}  // namespace

TEST_GROUP(Replay) {
  test::TemporaryFolder folder;
  test::MadeSession made{.frames = 9, .width_px = 40, .height_px = 30};
  std::shared_ptr<const session::Session> session;

  void setup() override {
    test::write_made_session(made, folder.path());
    load();
  }
  void load() {
    const auto opened = open_recording(folder.path(), {});
    SUCCEEDS(opened);
    session = *opened;
  }
  std::unique_ptr<ReplayCamera> camera(ReplayCameraConfig config = {.buffers = 3, .decode_threads = 2}) {
    auto opened = ReplayCamera::open(session, config);
    SUCCEEDS(opened);
    return std::move(*opened);
  }
};

TEST(Replay, EveryPictureComesOnceInOrderWithItsStamp) {
  const auto sut = camera();
  SUCCEEDS(sut->configure({.region = session->sensor.region}));
  SUCCEEDS(sut->start());
  for (std::size_t i = 0; i < session->frames.size(); ++i) {
    const auto frame = sut->next_frame(seconds{5});
    SUCCEEDS(frame);
    LONGS_EQUAL(i, frame->sequence);
    CHECK(session->frames[i].exposure_mid == frame->exposure_mid);
    const auto expected = image::read_png(session->frames[i].file);
    CHECK(std::equal(expected->pixels.begin(), expected->pixels.end(), frame->pixels.begin(),
                     frame->pixels.end()));
    sut->release(*frame);
  }
  FAILS_NAMING(Errc::Timeout, "at its end", sut->next_frame(seconds{5}));
  CHECK(sut->health().finished);
  LONGS_EQUAL(9, sut->health().frames);
}

TEST(Replay, CallsInTheWrongOrderAreRefused) {
  const auto sut = camera();
  FAILS_NAMING(Errc::WrongState, "start before configure", sut->start());
  FAILS_NAMING(Errc::WrongState, "before start", sut->next_frame(seconds{0}));
  SUCCEEDS(sut->configure({.region = session->sensor.region}));
  SUCCEEDS(sut->start());
  FAILS_NAMING(Errc::WrongState, "while running", sut->configure({.region = session->sensor.region}));
  FAILS_NAMING(Errc::WrongState, "", sut->start());
  SUCCEEDS(sut->stop());
  SUCCEEDS(sut->start());  // plays again from the beginning
  LONGS_EQUAL(0, sut->next_frame(seconds{5})->sequence);
}

TEST(Replay, OnlyTheRecordedRegionCanBeHad) {
  const auto sut = camera();
  geometry::Region other = session->sensor.region;
  other.height_px -= 1;
  FAILS_NAMING(Errc::BadValue, "another region", sut->configure({.region = other}));
}

TEST(Replay, FramesLentOutStopTheDecodersAndNothingIsSkipped) {
  const auto sut = camera({.buffers = 2, .decode_threads = 2});
  SUCCEEDS(sut->configure({.region = session->sensor.region}));
  SUCCEEDS(sut->start());
  const auto first = sut->next_frame(seconds{5});
  const auto second = sut->next_frame(seconds{5});
  SUCCEEDS(second);
  FAILS_NAMING(Errc::Timeout, "", sut->next_frame(std::chrono::milliseconds{1}));
  sut->release(*first);
  LONGS_EQUAL(2, sut->next_frame(seconds{5})->sequence);
}

TEST(Replay, PictureThatCannotBeReadEndsItWithItsName) {
  std::ofstream{session->frames[4].file} << "rubbish";
  const auto sut = camera();
  SUCCEEDS(sut->configure({.region = session->sensor.region}));
  SUCCEEDS(sut->start());
  for (int i = 0; i < 4; ++i) {
    const auto frame = sut->next_frame(seconds{5});
    SUCCEEDS(frame);
    sut->release(*frame);
  }
  const std::string name = session->frames[4].file.filename().string();
  const auto broken = sut->next_frame(seconds{5});
  CHECK(!broken);
  STRCMP_CONTAINS(name.c_str(), to_line(broken.error()).c_str());
  STRCMP_CONTAINS(name.c_str(), to_line(sut->next_frame(seconds{5}).error()).c_str());
}

TEST(Replay, MayBeThrownAwayAtAnyTime) {
  const auto sut = camera();
  SUCCEEDS(sut->configure({.region = session->sensor.region}));
  SUCCEEDS(sut->start());
  SUCCEEDS(sut->next_frame(seconds{5}));
}

TEST(Replay, PosesComeInOrderOnBothClocks) {
  ReplayPoses sut{session};
  FAILS_NAMING(Errc::WrongState, "before start", sut.next_pose(seconds{0}));
  SUCCEEDS(sut.start());
  FAILS_NAMING(Errc::WrongState, "twice", sut.start());
  for (std::size_t i = 0; i < session->poses.size(); ++i) {
    const auto pose = sut.next_pose(seconds{0});
    SUCCEEDS(pose);
    LONGS_EQUAL(i, pose->sequence);
    CHECK(session->poses[i].stamp == pose->stamp);
    // Robot clock minus sensor clock is 7 ms in the made head.
    LONGS_EQUAL(7'000'000, (pose->stamp.time_since_epoch() - pose->stamp_sensor->time_since_epoch()).count());
  }
  FAILS_NAMING(Errc::Timeout, "at their end", sut.next_pose(seconds{0}));
  CHECK(sut.health().state == PoseState::Finished);
}

TEST(Replay, TellsTheStateThatWasRecorded) {
  CHECK_FALSE(camera()->state()->told());
  geometry::SensorModel recorded = test::made_sensor(made);
  recorded.camera_state = geometry::plain_state();
  recorded.camera_state[geometry::StateKey::MirrorX] = 1;
  std::ofstream{folder.path() / "cam0/sensor.yaml"} << config::sensor_yaml_text(recorded, "made");
  const auto opened = open_recording(folder.path(), {});
  SUCCEEDS(opened);
  const auto sut = ReplayCamera::open(*opened, {});
  SUCCEEDS(sut);
  CHECK(recorded.camera_state == *(*sut)->state());
  // What is told to it changes no picture.
  CHECK(recorded.camera_state == *(*sut)->set_state(geometry::plain_state()));
}

TEST(Replay, AHeadThatWasCalibratedInAnotherStateIsRefusedByName) {
  geometry::SensorModel recorded = test::made_sensor(made), other = recorded;
  recorded.camera_state = geometry::plain_state();
  std::ofstream{folder.path() / "cam0/sensor.yaml"} << config::sensor_yaml_text(recorded, "made");
  other.camera_state = geometry::plain_state();
  other.camera_state[geometry::StateKey::MirrorY] = 1;
  auto file = folder.write("other.yaml", config::sensor_yaml_text(other, "other"));
  FAILS_NAMING(Errc::Refused, "no longer mirrors top to bottom", open_recording(folder.path(), file));
  // One that does not tell is taken for the usual, and a recording that does not tell for anything.
  other.camera_state = {};
  file = folder.write("other.yaml", config::sensor_yaml_text(other, "other"));
  SUCCEEDS(open_recording(folder.path(), file));
  recorded.camera_state[geometry::StateKey::BinningX] = 2;
  std::ofstream{folder.path() / "cam0/sensor.yaml"} << config::sensor_yaml_text(recorded, "made");
  FAILS_NAMING(Errc::Refused, "binning along the rows is 2", open_recording(folder.path(), file));
}

TEST(Replay, OtherHeadReplacesOnlyWhatBelongsToAHead) {
  geometry::SensorModel other = test::made_sensor(made);
  other.camera.fu_px = 1234;
  other.laser_plane.distance_mm = -99;
  other.T_flange_cam.translation() = Vec3{1, 2, 3};
  other.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 1, .height_px = 1};
  other.pose_clock_offset = Nanoseconds{1};
  other.rate_hz = 5;
  const auto file = folder.write("other.yaml", config::sensor_yaml_text(other, "other"));
  const auto opened = open_recording(folder.path(), file);
  SUCCEEDS(opened);
  const geometry::SensorModel& got = (*opened)->sensor;
  DOUBLES_EQUAL(1234, got.camera.fu_px, 1e-9);
  DOUBLES_EQUAL(-99, got.laser_plane.distance_mm, 1e-6);
  TRANSFORMS_EQUAL(other.T_flange_cam, got.T_flange_cam, 1e-6, 1e-6);
  LONGS_EQUAL(made.width_px, got.region.width_px);
  LONGS_EQUAL(7'000'000, got.pose_clock_offset.count());
  DOUBLES_EQUAL(100, *got.rate_hz, 0);
}

}  // namespace biteline::hal::replay
