// SPDX-License-Identifier: MIT
#include "host/bite_line/place/finish.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <random>

#include "host/bite_line/place/confidence.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/cloud/flagged.hpp"
#include "tests/unit/host/bite_line/drum.hpp"

namespace biteline::bite_line {
namespace {

/// A level line round the egg, of which `bridged_mm` were not seen.
PlacedLine level_line(const Outline& outline, double bridged_mm) {
  PlacedLine line{.points = {}, .length_mm = outline.length_mm(), .bridged_mm = bridged_mm};
  for (double s = 0; s < outline.length_mm(); s += 0.5) {
    const Vec2 plan = outline.point(s), normal = outline.normal(s);
    line.points.push_back(
        {.position = {plan.x(), plan.y(), 25}, .normal = {normal.x(), normal.y(), 0}, .own_z_mm = 25});
  }
  return line;
}

Decision decided(const Side& side, double confidence) {
  const auto cols = static_cast<std::size_t>(side.field.grid.cols);
  return {.refusal = std::nullopt,
          .confidence = confidence,
          .of_line = confidence,
          .paths = {{.confidence = confidence,
                     .row = std::vector<double>(cols, 60.0),
                     .mean_height_mm = 25,
                     .turn_rad = 0.5,
                     .seen_share = 1}}};
}

}  // namespace

TEST_GROUP(Finish) {
  const Side side = test::drum_side([](double, double z) { return test::groove_mm(z, 25); },
                                    {.s_mm = 0.7, .z_mm = 0.1, .z_begin_mm = 10, .z_end_mm = 40});
  void teardown() override {
    test::forgive_underflow();
  }
};

TEST(Finish, ASeenLineKeepsTheDecisionsConfidenceAndIsEven) {
  const Extraction sut = finish(side, decided(side, 0.9), level_line(side.outline, 0), {});
  CHECK(sut.found);
  DOUBLES_EQUAL(0.9, sut.confidence, 1e-12);
  for (std::size_t i = 0; i < sut.line.points.size(); ++i) {
    const auto& p = sut.line.points[i];
    DOUBLES_EQUAL(line_held_of(0.9), p.confidence, 1e-9);
    DOUBLES_EQUAL(0.5, (sut.line.points[(i + 1) % sut.line.points.size()].position - p.position).norm(),
                  0.01);
  }
  LONGS_EQUAL(1, sut.candidates.size());
  DOUBLES_EQUAL(side.outline.length_mm(), sut.candidates.front().length_mm, 5);
}

TEST(Finish, WhatWasBridgedLowersTheConfidence) {
  const double length = side.outline.length_mm();
  const Extraction sut = finish(side, decided(side, 0.9), level_line(side.outline, 0.2 * length), {});
  CHECK(sut.found);
  DOUBLES_EQUAL(0.72, sut.confidence, 1e-9);
}

TEST(Finish, ALineBelowTheLimitIsForReviewWithTheTrueReasonAndItsBridgeFlagged) {
  const double length = side.outline.length_mm();
  PlacedLine line = level_line(side.outline, 0.2 * length);
  const std::size_t bridged = line.points.size() / 5;
  for (std::size_t i = 0; i < bridged; ++i) line.points[i].to_visible_mm = 1;
  const Extraction sut = finish(side, decided(side, 0.6), line, {});
  CHECK_FALSE(sut.found);
  CHECK(sut.verdict() == Verdict::Review);
  CHECK(sut.refusal->code == Refused::TooMuchBridged);
  STRCMP_CONTAINS("0.48", sut.reason().c_str());
  DOUBLES_EQUAL(0.2, cloud::flagged_share(sut.line), 0.01);
  DOUBLES_EQUAL(0.48, sut.confidence, 1e-9);
  LONGS_EQUAL(1, sut.candidates.size());
}

TEST(Finish, WhatTheArmGivesIsInU95WithoutAHeadToo) {
  const PlacedLine placed = level_line(side.outline, 0);
  const Extraction still = finish(side, decided(side, 0.9), placed, {});
  CHECK_FALSE(still.arm.has_value());
  const Vec3 somewhere = still.line.points.front().position;
  const Extraction sut =
      finish(side, decided(side, 0.9), placed, {},
             {.head = {}, .arm = {{.sigma_mm = 0.05, .profiles = 200, .places = {{somewhere, 0.05}}}}});
  CHECK(sut.found);
  CHECK(sut.arm.has_value());
  CHECK_FALSE(sut.head_in_u95);
  // Of a round normal distribution in the plane across: sqrt(-2 ln 0.05) deviations.
  DOUBLES_EQUAL(0, still.line.points.front().u95_mm.value_or(-1), 0.001);
  DOUBLES_EQUAL(2.4477 * 0.05, sut.line.points.front().u95_mm.value_or(-1), 0.001);
}

TEST(Finish, ADecisionForReviewIsALineWithMoreThanATenthFlaggedWhateverItsPointsSay) {
  Decision decision = decided(side, 0.9);
  decision.refusal = Refusal{Refused::Rivalled, "two"};
  decision.for_review = true;
  PlacedLine line = level_line(side.outline, 0);
  for (std::size_t i = 0; i < line.points.size() / 5; ++i) line.points[i].hold = 0.1;
  const Extraction some = finish(side, decision, line, {});
  CHECK(some.verdict() == Verdict::Review);
  CHECK(some.refusal->code == Refused::Rivalled);
  DOUBLES_EQUAL(0.2, cloud::flagged_share(some.line), 0.01);
  CHECK(some.confidence < 0.5);
  // Nothing at any place speaks against it: then all of it is to be looked at.
  const Extraction all = finish(side, decision, level_line(side.outline, 0), {});
  DOUBLES_EQUAL(1, cloud::flagged_share(all.line), 1e-9);
  // One that is likely another one is unsure everywhere.
  decision.of_line = 0.2;
  for (const cloud::LinePoint& point : finish(side, decision, line, {}).line.points)
    CHECK(point.confidence <= 0.2);
}

TEST(Finish, ARefusedDecisionStaysItsOwnRefusal) {
  Decision decision = decided(side, 0.3);
  decision.refusal = Refusal{Refused::Rivalled, "two"};
  const Extraction sut = finish(side, decision, {}, {});
  CHECK(sut.verdict() == Verdict::Refused);
  CHECK(sut.refusal->code == Refused::Rivalled);
  DOUBLES_EQUAL(0.3, sut.confidence, 1e-12);
}

namespace {

/// One in fourteen that so large a share of the line lies on a layer 5 mm away: sure, but for U95.
PlacedLine far_layer_line(const Outline& outline, double share) {
  PlacedLine line = level_line(outline, 0);
  const auto count = static_cast<std::size_t>(share * static_cast<double>(line.points.size()));
  for (std::size_t i = 0; i < count; ++i) {
    line.points[i].hold = 0.93;
    line.points[i].other_mm = 5;
  }
  return line;
}

}  // namespace

TEST(Finish, ALineWhoseU95IsTooLargeOverMoreThanATenthIsForReviewForThat) {
  const Extraction little = finish(side, decided(side, 0.9), far_layer_line(side.outline, 0.08), {});
  CHECK(little.found);
  DOUBLES_EQUAL(0.9, little.confidence, 0.03);
  const Extraction sut = finish(side, decided(side, 0.9), far_layer_line(side.outline, 0.3), {});
  CHECK_FALSE(sut.found);
  CHECK(sut.refusal->code == Refused::TooMuchUncertain);
  STRCMP_CONTAINS("U95 is above 1 mm on 30 %", sut.reason().c_str());
  CHECK(sut.verdict() == Verdict::Review);
  DOUBLES_EQUAL(0.3, cloud::flagged_share(sut.line), 0.01);
  CHECK(sut.confidence < 0.5);
}

TEST(Finish, ALineForReviewTellsWhatStandsInFrontOfIt) {
  PlacedLine line = level_line(side.outline, 0);
  for (std::size_t i = 0; i < line.points.size() / 5; ++i) line.points[i].hold = 0.1;
  const Extraction alone = finish(side, decided(side, 0.9), line, {});
  STRCMP_CONTAINS("is unsure", alone.refusal->reason.c_str());
  CHECK(alone.refusal->reason.find("stands in front") == std::string::npos);
  line.thing_beside_mm = 12;
  const Extraction sut = finish(side, decided(side, 0.9), line, {});
  STRCMP_CONTAINS(
      "something stands in front of it over 12 mm (a pin, a clamp, a cable or the sole's own edge)",
      sut.refusal->reason.c_str());
}

TEST_GROUP(ScanPoints){};

TEST(ScanPoints, RunsGiveAllTheirPoints) {
  Shoe shoe;
  shoe.T_base_shoe.translation() = Vec3{100, 0, 0};
  const std::vector<Eigen::Vector3f> raw{{100, 0, 0}, {101, 0, 0}, {102, 0, 0}, {103, 0, 0}};
  const std::vector<Eigen::Vector3f> means{{100.5F, 0, 0}, {102.5F, 0, 0}};
  const std::vector<std::uint32_t> first{0, 2};
  const std::vector<std::uint32_t> of_shoe{0};
  shoe.index.push_back(1);
  const auto runs = points_behind({.means = means, .points = raw, .first_point = first}, shoe, of_shoe);
  LONGS_EQUAL(2, runs.size());
  DOUBLES_EQUAL(2, runs[0].x(), 1e-5);
  DOUBLES_EQUAL(3, runs[1].x(), 1e-5);
}

TEST(ScanPoints, NeighboursOfOneProfileMakeARun) {
  cloud::PointCloud cloud;
  cloud.points = {{0, 0, 0},     {0.1F, 0, 0}, {0.2F, 0, 0}, {0.3F, 0, 0},
                  {0.35F, 0, 0}, {9, 0, 0},    {0.4F, 0, 0}};
  cloud.profile.assign(7, 4);
  PointRuns sut = runs_of(cloud);
  LONGS_EQUAL(4, sut.means.size());
  DOUBLES_EQUAL(0.1, sut.means[0].x(), 1e-6);
  DOUBLES_EQUAL(0.325, sut.means[1].x(), 1e-6);
  LONGS_EQUAL(3, sut.first_point[1]);
  DOUBLES_EQUAL(9, sut.means[2].x(), 1e-6);
  cloud.profile = {4, 4, 7, 7, 7, 7, 7};
  sut = runs_of(cloud);
  DOUBLES_EQUAL(0.05, sut.means[0].x(), 1e-6);
  LONGS_EQUAL(2, sut.first_point[1]);
  LONGS_EQUAL(0, runs_of({}).means.size());
}

TEST(ScanPoints, WithoutProfilesOnlyNeighboursInTheirOrderAreJoined) {
  cloud::PointCloud cloud;
  for (int i = 0; i < 9000; ++i) {
    const int row = i / 300;
    cloud.points.emplace_back(0.07F * static_cast<float>(i % 300), static_cast<float>(row), 0.0F);
  }
  const std::size_t runs = runs_of(cloud).means.size();
  CHECK(runs > 9000 / 5 && runs < 9000 / 3);
  LONGS_EQUAL(runs, runs_of(cloud).scan(cloud.points).means.size());
  std::shuffle(cloud.points.begin(), cloud.points.end(), std::mt19937{3});
  LONGS_EQUAL(0, runs_of(cloud).means.size());
  LONGS_EQUAL(9000, runs_of(cloud).scan(cloud.points).means.size());
  LONGS_EQUAL(1, runs_of(cloud).scan(cloud.points).run(17).size());
}

TEST(ScanPoints, RunsAreTheSameAsOneThreadFindsThem) {
  // More than one thread's piece, and profiles that reach over the pieces' ends.
  cloud::PointCloud cloud;
  for (std::uint32_t i = 0; i < 60'000; ++i) {
    const std::uint32_t profile = i / 7000;
    cloud.points.emplace_back(0.07F * static_cast<float>(i % 7000), static_cast<float>(profile), 0.0F);
    cloud.profile.push_back(profile);
  }
  const PointRuns sut = runs_of(cloud);
  std::size_t k = 0;
  for (std::size_t first = 0; first < cloud.size(); ++k) {
    const std::size_t profile_end = std::min<std::size_t>(cloud.size(), (first / 7000 + 1) * 7000);
    const Run run = run_from({cloud.points.data(), profile_end}, first);
    LONGS_EQUAL(first, sut.first_point[k]);
    CHECK(run.mean == sut.means[k]);
    first = run.end;
  }
  LONGS_EQUAL(k, sut.means.size());
}

}  // namespace biteline::bite_line
