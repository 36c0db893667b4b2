// SPDX-License-Identifier: MIT
#include "host/intake/scan_intake.hpp"

#include <CppUTest/TestHarness.h>
#include <sys/stat.h>

#include <fstream>

#include "host/intake/recorded_scan.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/made_profile.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::intake {
namespace {

constexpr std::uint64_t k_scan_id = 77;

wire::Bytes packet_of(wire::Body body, std::uint64_t sequence = 0) {
  wire::Bytes packet;
  wire::encode({.scan_id = k_scan_id, .sequence = sequence, .body = std::move(body)}, packet);
  return packet;
}

Hello made_hello() {
  Hello hello;
  hello.scan_id = k_scan_id;
  hello.sensor.name = "left";
  hello.sensor.frames_expected = 3;
  hello.sensor.model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 10, .height_px = 10};
  hello.sensor.model.T_flange_cam.translation() = Vec3{1, 2, 3};
  return hello;
}

}  // namespace

TEST_GROUP(ScanIntake) {
  test::TemporaryFolder folder;

  ScanIntake begin() {
    const Hello hello = made_hello();
    Result<ScanIntake> intake = ScanIntake::begin(folder.path(), hello, packet_of(hello.sensor));
    SUCCEEDS(intake);
    return std::move(*intake);
  }
  static void take_profile(ScanIntake & intake, std::uint64_t sequence) {
    profile::Profile profile = test::made_profile(sequence, 20);
    const wire::Bytes packet = packet_of(profile, sequence);
    SUCCEEDS(intake.take(ProfileEvent{.sequence = sequence, .profile = std::move(profile)}, packet));
  }
  static void take_end(ScanIntake & intake, std::uint64_t sequence, std::uint16_t errc = 0) {
    wire::EndOfScan end;
    end.errc = errc;
    end.where = "camera";
    end.counters.frames = 3;
    SUCCEEDS(intake.take(end, packet_of(end, sequence)));
  }
};

TEST(ScanIntake, SuccessorFindsEverythingThatWasTaken) {
  {
    ScanIntake first = begin();
    take_profile(first, 0);
    take_profile(first, 1);
  }
  CHECK(ScanIntake::is_in(folder.path()));
  Result<ScanIntake> sut = ScanIntake::recover(folder.path());
  SUCCEEDS(sut);
  LONGS_EQUAL(k_scan_id, sut->position().scan_id);
  LONGS_EQUAL(2, sut->position().next_sequence);
  LONGS_EQUAL(2, sut->profiles());
  CHECK(!sut->ended());
  take_profile(*sut, 2);
  take_end(*sut, 3);
  const ScanOutcome outcome = sut->finish();
  LONGS_EQUAL(3, outcome.counts.profiles);
  LONGS_EQUAL(0, outcome.counts.profiles_lost);
  LONGS_EQUAL(3, outcome.sensor_counters.frames);
  LONGS_EQUAL(3, outcome.poses.size());
  LONGS_EQUAL(2, outcome.poses.back().profile);
  STRCMP_EQUAL("left", outcome.sensor.name.c_str());
  DOUBLES_EQUAL(2, outcome.sensor.model.T_flange_cam.translation().y(), 0);
  CHECK(!outcome.failure);
}

TEST(ScanIntake, RecoveredAndStraightScansAreTheSame) {
  test::TemporaryFolder other;
  const Hello hello = made_hello();
  Result<ScanIntake> straight = ScanIntake::begin(other.path(), hello, packet_of(hello.sensor));
  SUCCEEDS(straight);
  {
    ScanIntake first = begin();
    take_profile(first, 0);
  }
  Result<ScanIntake> resumed = ScanIntake::recover(folder.path());
  SUCCEEDS(resumed);
  take_profile(*straight, 0);
  for (std::uint64_t i = 1; i < 5; ++i) {
    take_profile(*straight, i);
    take_profile(*resumed, i);
  }
  CHECK(straight->finish().cloud.points == resumed->finish().cloud.points);
}

TEST(ScanIntake, MessageThatWasBeingWrittenIsCutOffAndAskedForAgain) {
  {
    ScanIntake first = begin();
    take_profile(first, 0);
    take_profile(first, 1);
  }
  const auto file = folder.path() / "scan.btln";
  const auto whole_bytes = std::filesystem::file_size(file);
  std::filesystem::resize_file(file, whole_bytes - 7);
  Result<ScanIntake> sut = ScanIntake::recover(folder.path());
  SUCCEEDS(sut);
  LONGS_EQUAL(1, sut->position().next_sequence);
  take_profile(*sut, 1);
  LONGS_EQUAL(whole_bytes, std::filesystem::file_size(file));
}

TEST(ScanIntake, DamagedFileGoesOnFromTheLastGoodMessage) {
  {
    ScanIntake first = begin();
    for (std::uint64_t i = 0; i < 3; ++i) take_profile(first, i);
  }
  const auto file = folder.path() / "scan.btln";
  {
    std::fstream stream{file, std::ios::in | std::ios::out | std::ios::binary};
    stream.seekp(-20, std::ios::end);
    stream.put('\x55');
  }
  Result<ScanIntake> sut = ScanIntake::recover(folder.path());
  SUCCEEDS(sut);
  LONGS_EQUAL(2, sut->position().next_sequence);
}

TEST(ScanIntake, LossesAreKeptToo) {
  {
    ScanIntake first = begin();
    take_profile(first, 0);
    SUCCEEDS(first.take(LossEvent{.messages = 4}, packet_of(wire::Gap{.first = 0, .count = 5})));
    LONGS_EQUAL(5, first.position().next_sequence);
  }
  Result<ScanIntake> sut = ScanIntake::recover(folder.path());
  SUCCEEDS(sut);
  LONGS_EQUAL(5, sut->position().next_sequence);
  take_profile(*sut, 5);
  take_end(*sut, 6);
  LONGS_EQUAL(4, sut->finish().messages_lost);
}

TEST(ScanIntake, ScanWithoutItsEndOrWithABadOneIsAFailure) {
  ScanIntake cut = begin();
  take_profile(cut, 0);
  const ScanOutcome without_end = cut.finish();
  CHECK(without_end.failure.has_value());
  LONGS_EQUAL(static_cast<int>(Errc::ConnectionLost), static_cast<int>(without_end.failure->code));
  LONGS_EQUAL(20, without_end.counts.points);

  test::TemporaryFolder other;
  const Hello hello = made_hello();
  Result<ScanIntake> failed = ScanIntake::begin(other.path(), hello, packet_of(hello.sensor));
  take_end(*failed, 0, static_cast<std::uint16_t>(Errc::DeviceLost));
  LONGS_EQUAL(static_cast<int>(Errc::DeviceLost), static_cast<int>(failed->finish().failure->code));
}

TEST(ScanIntake, TestPatternIsNoScanThoughItIsWhole) {
  Hello hello = made_hello();
  hello.sensor.test_pattern = true;
  {
    Result<ScanIntake> sut = ScanIntake::begin(folder.path(), hello, packet_of(hello.sensor));
    SUCCEEDS(sut);
    for (std::uint64_t i = 0; i < 3; ++i) take_profile(*sut, i);
    take_end(*sut, 3);
    const ScanOutcome outcome = sut->finish();
    CHECK(outcome.failure.has_value());
    STRCMP_CONTAINS("test pattern", outcome.failure->where.c_str());
  }
  // Nor is it one when a successor of this process, or a replay, reads it.
  Result<ScanIntake> again = ScanIntake::recover(folder.path());
  SUCCEEDS(again);
  STRCMP_CONTAINS("test pattern", again->finish().failure->where.c_str());
  FAILS_NAMING(Errc::BadValue, "test pattern", read_recorded_scan(folder.path() / "scan.btln", {}));
}

TEST(ScanIntake, AScanWhoseCameraWasNotAsCalibratedIsRefusedByName) {
  using geometry::StateKey;
  for (const StateKey key : {StateKey::MirrorX, StateKey::MirrorY, StateKey::Turn, StateKey::BinningY}) {
    test::TemporaryFolder place;
    Hello hello = made_hello();
    hello.sensor.model.camera_state = geometry::plain_state();
    hello.sensor.camera_state = geometry::plain_state();
    hello.sensor.camera_state[key] = key == StateKey::Turn ? 180 : key == StateKey::BinningY ? 2 : 1;
    const char* const words = geometry::state_table()[static_cast<std::size_t>(key)].words;
    {
      Result<ScanIntake> sut = ScanIntake::begin(place.path(), hello, packet_of(hello.sensor));
      SUCCEEDS(sut);
      for (std::uint64_t i = 0; i < 3; ++i) take_profile(*sut, i);
      take_end(*sut, 3);
      const ScanOutcome outcome = sut->finish();
      CHECK(outcome.failure.has_value());
      CHECK(outcome.failure->code == Errc::Refused);
      STRCMP_CONTAINS(words, outcome.failure->where.c_str());
    }
    Result<ScanIntake> again = ScanIntake::recover(place.path());
    SUCCEEDS(again);
    STRCMP_CONTAINS(words, again->finish().failure->where.c_str());
    FAILS_NAMING(Errc::Refused, words, read_recorded_scan(place.path() / "scan.btln", {}));
  }
}

TEST(ScanIntake, AScanThatTellsNoStateIsTakenAsBefore) {
  Hello hello = made_hello();
  hello.sensor.model.camera_state = geometry::plain_state();
  Result<ScanIntake> sut = ScanIntake::begin(folder.path(), hello, packet_of(hello.sensor));
  SUCCEEDS(sut);
  take_end(*sut, 0);
  const auto failure = sut->finish().failure;
  CHECK(!failure || failure->code != Errc::Refused);
}

TEST(ScanIntake, FullDiskIsToldAndLeavesAWholeFile) {
  ScanIntake sut = begin();
  take_profile(sut, 0);
  const auto file = folder.path() / "scan.btln";
  const auto before_bytes = std::filesystem::file_size(file);
  profile::Profile profile = test::made_profile(1, 20);
  const wire::Bytes packet = packet_of(profile, 1);
  {
    const test::FullDisk full{before_bytes + 100};
    FAILS_NAMING(Errc::DiskFull, "scan.btln",
                 sut.take(ProfileEvent{.sequence = 1, .profile = profile}, packet));
  }
  LONGS_EQUAL(before_bytes, std::filesystem::file_size(file));
  LONGS_EQUAL(1, sut.position().next_sequence);
  // Room again: nothing was lost, the sensor still has it.
  take_profile(sut, 1);
  LONGS_EQUAL(2, sut.profiles());
}

TEST(ScanIntake, OtherFilesAreRefused) {
  folder.write("scan.btln", "something else entirely");
  FAILS_NAMING(Errc::BadFormat, "not a recorded scan", ScanIntake::recover(folder.path()));
  folder.write("scan.btln", "BTLNSCAN");
  FAILS_NAMING(Errc::BadFormat, "without its beginning", ScanIntake::recover(folder.path()));
}

TEST(ScanIntake, PipesDevicesAndFoldersAreNoRecordings) {
  const std::filesystem::path file = folder.path() / "scan.btln";
  // Its reader would wait for ever: it holds the other end itself.
  LONGS_EQUAL(0, ::mkfifo(file.c_str(), 0600));
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected", ScanIntake::recover(folder.path()));
  std::filesystem::remove(file);
  std::filesystem::create_symlink("/dev/zero", file);
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected", ScanIntake::recover(folder.path()));
  std::filesystem::remove(file);
  std::filesystem::create_directory(file);
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected", ScanIntake::recover(folder.path()));
}

TEST(ScanIntake, FinishedScanLeavesNothing) {
  ScanIntake sut = begin();
  sut.forget();
  CHECK(!ScanIntake::is_in(folder.path()));
}

}  // namespace biteline::intake
