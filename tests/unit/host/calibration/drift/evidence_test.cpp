// SPDX-License-Identifier: MIT
#include "host/calibration/drift/evidence.hpp"

#include <CppUTest/TestHarness.h>

#include <limits>

#include "tests/support/errors.hpp"
#include "tests/unit/host/calibration/drift/seen_ball.hpp"

namespace biteline::drift {

TEST_GROUP(Evidence){};

TEST(Evidence, ASoundHeadShowsNoQuantityBeyondFourDeviations) {
  const auto sut = look_at(scan_ball({}).view(), ball_head());
  SUCCEEDS(sut);
  CHECK(sut->pairs >= 200);
  CHECK(sut->after_mm < 0.02);
  for (int i = 0; i < k_quantities; ++i)
    CHECK(std::abs(sut->sums().alone()[i]) < 4 * std::max(sut->sums().alone_sigma()[i], 0.02));
}

TEST(Evidence, WhatDriftedIsMeasured) {
  for (int i = 0; i < k_quantities; ++i) {
    Vector drifted = Vector::Zero();
    drifted[i] = 2;
    const auto sound = look_at(scan_ball({}).view(), ball_head());
    const auto sut = look_at(scan_ball({.drifted = drifted}).view(), ball_head());
    SUCCEEDS(sound);
    SUCCEEDS(sut);
    const double sigma = sut->sums().alone_sigma()[i];
    if (sigma < 0.15) DOUBLES_EQUAL(2, sut->sums().alone()[i] - sound->sums().alone()[i], 0.2 + 4 * sigma);
  }
}

TEST(Evidence, TheSecondPassTurnedShowsMoreThanTheSameWayTwice) {
  const auto same = look_at(scan_ball({.turned_rad = 0}).view(), ball_head());
  const auto turned = look_at(scan_ball({}).view(), ball_head());
  SUCCEEDS(same);
  SUCCEEDS(turned);
  // A mounting turned about the travel is off alike in both passes, unless one of them is turned.
  for (const int i : {7, 9, 10}) CHECK(turned->sums().alone_sigma()[i] < 0.5 * same->sums().alone_sigma()[i]);
}

TEST(Evidence, AScanThatSeesNothingTwiceSaysWhatToDo) {
  BallScan once = scan_ball({});
  const std::size_t half = once.points_base.size() / 2;
  once.points_base.resize(half);
  once.profile.resize(half);
  const auto sut = look_at(once.view(), ball_head());
  FAILS_NAMING(Errc::Degenerate, "calibration check", sut);
}

TEST(Evidence, NothingAtAllIsNoEvidence) {
  FAILS_NAMING(Errc::Degenerate, "calibration check", look_at({}, ball_head()));
}

TEST(Evidence, PlacesThatAreNoNumbersAndProfilesWithoutPoseAreLeftOut) {
  BallScan scan = scan_ball({});
  const auto clean = look_at(scan.view(), ball_head());
  for (std::size_t i = 0; i < scan.points_base.size(); i += 97)
    scan.points_base[i].y() = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 40; i < scan.points_base.size(); i += 997) scan.profile[i] = 9999;
  const auto sut = look_at(scan.view(), ball_head());
  SUCCEEDS(sut);
  CHECK(sut->seam.information.allFinite() && sut->seam.pull.allFinite());
  for (const int i : {7, 9, 10})
    DOUBLES_EQUAL(clean->sums().alone()[i], sut->sums().alone()[i], 5 * sut->sums().alone_sigma()[i]);
}

TEST(Evidence, ScansStampedInTheYear2026KeepTheirTimes) {
  BallScan scan = scan_ball({});
  for (PosedProfile& posed : scan.poses) posed.pose.time_s += 1.8e9;
  SUCCEEDS(look_at(scan.view(), ball_head()));
}

}  // namespace biteline::drift
