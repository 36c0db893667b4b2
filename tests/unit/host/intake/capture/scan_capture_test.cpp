// SPDX-License-Identifier: MIT
// What a recorded scan is worth.
#include "host/intake/capture/scan_capture.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::capture {

using calibration::Grade;

TEST_GROUP(ScanCapture) {
  TakenScan scan;

  void setup() override {
    scan = {};
    scan.count = {
        .profiles = 600, .without_stripe = 20, .not_usable = 0, .points = 600'000, .saturated = 1000};
    scan.seen.profiles = scan.seen.profiles_used = 600;
    scan.facts.complete = true;
    scan.facts.pictures = 600;
  }
  void is(Grade grade, const char* words) {
    const calibration::Verdict verdict = judge_scan(scan);
    CHECK(verdict.grade == grade);
    LONGS_EQUAL(1, verdict.reasons.size());
    STRCMP_CONTAINS(words, verdict.reasons.front().c_str());
  }
};

TEST(ScanCapture, AWholeScanIsGood) {
  const calibration::Verdict verdict = judge_scan(scan);
  CHECK(verdict.grade == Grade::Good);
  CHECK(verdict.reasons.empty());
}

TEST(ScanCapture, LossesMakeItFairAndEachIsNamed) {
  scan.count.without_stripe = 120;
  is(Grade::Fair, "20 % of the profiles show no stripe");
  setup();
  scan.count.saturated = 300'000;
  is(Grade::Fair, "50 % of the points are saturated");
  setup();
  scan.end.counters.frames_lost = 3;
  is(Grade::Fair, "3 pictures were lost");
  setup();
  scan.facts.pictures_left_out = 7;
  is(Grade::Fair, "7 pictures are not kept");
  setup();
  scan.facts.complete = false;
  is(Grade::Fair, "not complete");
  setup();
  scan.count.not_usable = 30;
  is(Grade::Fair, "5 % of the profiles have no pose");
}

TEST(ScanCapture, WhatCannotBeUsedIsBad) {
  scan.count.without_stripe = 400;
  is(Grade::Bad, "67 % of the profiles show no stripe");
  setup();
  scan.count.not_usable = 100;
  is(Grade::Bad, "17 % of the profiles have no pose");
  setup();
  scan.count.profiles = 3;
  scan.count.without_stripe = 0;
  is(Grade::Bad, "3 profiles: the arm did not move");
  setup();
  scan.end.errc = static_cast<std::uint16_t>(Errc::InterlockOpen);
  scan.end.where = "the laser went off: the door";
  is(Grade::Bad, "the scan was ended: the laser went off: the door");
  setup();
  scan.facts.fault = "no space left";
  is(Grade::Bad, "the recording was ended: no space left");
}

TEST(ScanCapture, TheCauseIsNamedByTheScansOwnCounts) {
  scan.count.not_usable = 600;
  scan.seen.profiles_used = 0;
  scan.seen.profiles_by_flag[0] = 600;  // pose_missing
  is(Grade::Bad, "0 of 600 profiles can be used: no pose (600)");
  CHECK(cause_of(scan)->code == intake::Refused::NoPoses);
  setup();
  CHECK_FALSE(cause_of(scan).has_value());
}

TEST(ScanCapture, AFolderThatIsThereIsLeftAlone) {
  const test::TemporaryFolder folder;
  FAILS_NAMING(Errc::WrongState, "name another folder",
               capture_scan({.board = "b", .sensor = "s", .session = folder.path()},
                            [](const ScanCount&) { return true; }));
}

}  // namespace biteline::capture
