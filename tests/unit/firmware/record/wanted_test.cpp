// SPDX-License-Identifier: MIT
#include "firmware/record/wanted.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "firmware/record/session_recorder.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::record {
namespace fs = std::filesystem;

TEST_GROUP(Wanted) {
  test::TemporaryFolder folder;
  fs::path series = folder.path() / "scan";
  geometry::SensorModel model;

  void setup() override {
    model.camera = {.fu_px = 2000, .fv_px = 2001, .cu_px = 160, .cv_px = 120};
    model.laser_plane = {.normal_cam = Vec3{0, 0.6, 0.8}, .distance_mm = 150};
    model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 320, .height_px = 240};
  }
  std::unique_ptr<SessionRecorder> begin() const {
    SessionRecorder::Config config;
    config.path = free_name(waiting_name(series));
    config.model = model;
    config.series = series;
    config.waits = true;
    config.realtime = runtime::RealtimeDemand::Ignored;
    auto begun = SessionRecorder::begin(std::move(config));
    SUCCEEDS(begun);
    return std::move(*begun);
  }
  void scan() const {
    const auto recorder = begin();
    recorder->request_finish(0);
  }
  /// Names beside each other, in order.
  std::string names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator{folder.path()})
      all.push_back(entry.path().filename().string());
    std::ranges::sort(all);
    std::string text;
    for (const std::string& one : all) text += one + " ";
    return text;
  }
};

TEST(Wanted, FirstOfEachThreeIsTaken) {
  EveryNth turn{3};
  for (const bool expected : {true, false, false, true, false, false, true}) {
    CHECK(turn.due() == expected);
    turn.pass();
  }
}

TEST(Wanted, NobodyAskedAndOnlyTheNewestWaits) {
  scan();
  scan();
  scan();
  LONGS_EQUAL(1, recordings_of(waiting_name(series)).size());
  LONGS_EQUAL(0, recordings_of(series).size());
}

TEST(Wanted, LastIsKeptWhileTheNextIsWritten) {
  scan();
  const auto writing = begin();
  const auto kept = keep_last(series);
  SUCCEEDS(kept);
  STRCMP_EQUAL("scan", kept->filename().c_str());
  FAILS_NAMING(Errc::FileNotFound, "scan-last", keep_last(series));
  CHECK(fs::exists(series / "recording.yaml"));
}

TEST(Wanted, NextIsKeptOnceAndTheOneBehindItWaits) {
  SUCCEEDS(keep_next(series));
  SUCCEEDS(keep_next(series));
  scan();
  STRCMP_EQUAL("scan ", names().c_str());
  scan();
  STRCMP_EQUAL("scan scan-last ", names().c_str());
}

TEST(Wanted, ScanThatNeverBeganIsNotTheNext) {
  SUCCEEDS(keep_next(series));
  begin()->discard();
  STRCMP_EQUAL("scan.wanted ", names().c_str());
  scan();
  STRCMP_EQUAL("scan ", names().c_str());
}

TEST(Wanted, FilesAsFolders) {
  series = folder.path() / "scan.mcap";
  scan();
  scan();
  const auto kept = keep_last(series);
  SUCCEEDS(kept);
  STRCMP_EQUAL("scan.mcap ", names().c_str());
  SUCCEEDS(keep_next(series));
  scan();
  STRCMP_EQUAL("scan-2.mcap scan.mcap ", names().c_str());
}

TEST(Wanted, WithoutItsFolderTheWishIsRefused) {
  FAILS_NAMING(Errc::WriteFailed, "wanted", keep_next(folder.path() / "none/scan"));
}

}  // namespace biteline::record
