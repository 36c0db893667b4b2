// SPDX-License-Identifier: MIT
#include "host/second_look/second_look.hpp"

#include <CppUTest/TestHarness.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tests/bench/second_look/made_work.hpp"

namespace biteline::second_look {
namespace {

using Made = sim::WorkFault::Kind;

/// An upper with 0.26 mm of wet glue: a gap of 4 mm at 100 mm, 1.5 mm less below about 200 mm, a drop at 300
/// mm.
const bench::WorkCase& faulty() {
  static const bench::WorkCase k_made{
      .shoe_class = sim::ShoeClass::Deep,
      .seed = 7008,
      .bare = true,
      .work = sim::Work::WetGlue,
      .plan = {.offset_mm = 4,
               .width_mm = 8,
               .faults = {{.kind = Made::Gap, .s_mm = 100, .length_mm = 4},
                          {.kind = Made::Narrow, .s_mm = 200, .length_mm = 20, .by_mm = 1.5, .high = false},
                          {.kind = Made::Drop, .s_mm = 300, .length_mm = 4, .by_mm = 12}}},
      .light_ratio = 0.7};
  return k_made;
}

const bench::MadeWork& faulty_work() {
  static const bench::MadeWork k_work = bench::make_work(faulty());
  return k_work;
}
const Findings& faulty_findings() {
  static const Findings k_findings =
      look_again(faulty_work().first, faulty_work().second, faulty_work().line, faulty_work().plan);
  return k_findings;
}

bool overlap(const Arc& a, const Arc& b) {
  return a.from_mm < b.to_mm && b.from_mm < a.to_mm;
}

}  // namespace

TEST_GROUP(SecondLook){};

TEST(SecondLook, FindsTheFaultsAndNoOthers) {
  const Findings& found = faulty_findings();
  CHECK_FALSE(found.refusal.has_value());
  LONGS_EQUAL(3, found.faults.size());
  const FaultKind kinds[] = {FaultKind::Missing, FaultKind::Narrow, FaultKind::Beside};
  for (std::size_t i = 0; i < 3; ++i) {
    STRCMP_EQUAL(name_of(kinds[i]), name_of(found.faults[i].kind));
    CHECK_TRUE(overlap(found.faults[i].along, faulty_work().faults[i].along));
  }
  const Arc &gap = found.faults[0].along, &true_gap = faulty_work().faults[0].along;
  DOUBLES_EQUAL(true_gap.from_mm, gap.from_mm, 1);  // profiles are 1 mm apart
  DOUBLES_EQUAL(true_gap.to_mm, gap.to_mm, 1);
}

TEST(SecondLook, EdgesLieNearAndAsOftenAsTheySayWithinTheirU95) {
  std::size_t edges = 0, within = 0, near = 0;
  for (const BandPlace& place : faulty_findings().places) {
    if (!place.high || place.along_mm < 110 || place.along_mm > 180) continue;
    double off_mm = 1e9;
    for (const Vec3& p : faulty_work().high_base) off_mm = std::min(off_mm, (p - place.high->base).norm());
    ++edges;
    within += off_mm <= std::hypot(place.high->u95_mm, 0.25) ? 1 : 0;  // truth is given every 0.5 mm
    near += std::abs(place.high->across_mm - faulty_work().plan.high_mm) <= 0.15 ? 1 : 0;
  }
  CHECK(edges > 50);
  CHECK(within * 20 >= edges * 18);  // of 19 in 20, as many as 70 edges that follow each other tell
  LONGS_EQUAL(edges, near);
}

TEST(SecondLook, AnotherLightIsTold) {
  DOUBLES_EQUAL(0.7, faulty_findings().light_ratio, 0.02);
}

TEST(SecondLook, WithoutTheStripeTheHeightTells) {
  cloud::PointCloud first = faulty_work().first;
  first.amplitude.clear();
  const Findings found = look_again(first, faulty_work().second, faulty_work().line, faulty_work().plan);
  CHECK_TRUE(std::ranges::any_of(found.faults, [](const Fault& fault) {
    return fault.kind == FaultKind::Missing && overlap(fault.along, faulty_work().faults[0].along);
  }));
}

/// A stitch, or a line's own grain, turns its normals from place to place by degrees.
TEST(SecondLook, NormalsThatTurnToAndFroChangeNothing) {
  cloud::ClosedLine line = faulty_work().line;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const Eigen::AngleAxisd turn{i % 4 < 2 ? 0.05 : -0.05, line.points[i].tangent};
    line.points[i].normal = turn * line.points[i].normal;
  }
  const Findings found = look_again(faulty_work().first, faulty_work().second, line, faulty_work().plan);
  LONGS_EQUAL(3, found.faults.size());
  DOUBLES_EQUAL(0, found.unclear_mm, 0);
}

TEST(SecondLook, AStripeThatIsAsBrightAsCanBeTellsByItsHeightAndWidth) {
  cloud::PointCloud first = faulty_work().first, second = faulty_work().second;
  for (cloud::PointCloud* cloud : {&first, &second})
    for (float& amplitude : cloud->amplitude) amplitude = 255;
  const Findings found = look_again(first, second, faulty_work().line, faulty_work().plan);
  LONGS_EQUAL(3, found.faults.size());
  DOUBLES_EQUAL(1, found.light_ratio, 0);
}

TEST(SecondLook, WhatIsLeftOutIsNotMissing) {
  PlannedBand plan = faulty_work().plan;
  const Arc& gap = faulty_work().faults[0].along;
  plan.left_out = {{.from_mm = gap.from_mm, .to_mm = gap.to_mm}};
  const Findings found = look_again(faulty_work().first, faulty_work().second, faulty_work().line, plan);
  CHECK_TRUE(std::ranges::none_of(found.faults, [](const Fault& f) { return f.kind == FaultKind::Missing; }));
}

TEST(SecondLook, WhatThePlanWorksTwiceIsNotDoubled) {
  bench::WorkCase made = faulty();
  made.plan.faults = {{.kind = Made::Double, .s_mm = 150, .length_mm = 10}};
  const bench::MadeWork work = bench::make_work(made);
  const auto doubled = [&](const PlannedBand& plan) {
    const Findings found = look_again(work.first, work.second, work.line, plan);
    return std::ranges::count(found.faults, FaultKind::Doubled, &Fault::kind);
  };
  LONGS_EQUAL(1, doubled(work.plan));
  PlannedBand plan = work.plan;
  const Arc& twice = work.faults[0].along;
  plan.twice = {{.from_mm = twice.from_mm - 2, .to_mm = twice.to_mm + 2}};
  LONGS_EQUAL(0, doubled(plan));
}

/// A boot whose ridges make a change that seems to be one of the work, and is told nearly nowhere.
TEST(SecondLook, AChangeThatIsHardlyEverToldIsNone) {
  const bench::MadeWork work = bench::make_work(bench::work_case(30161000, 119));
  const Findings found = look_again(work.first, work.second, work.line, work.plan);
  CHECK_TRUE(found.refusal && found.refusal->code == Refused::NothingToTell);
  LONGS_EQUAL(0, found.faults.size());
}

TEST(SecondLook, WorkWithoutATraceIsNotJudged) {
  bench::WorkCase made = faulty();
  made.work = sim::Work::Unseen;
  const bench::MadeWork work = bench::make_work(made);
  const Findings found = look_again(work.first, work.second, work.line, work.plan);
  CHECK_TRUE(found.refusal.has_value());
  CHECK_TRUE(found.refusal->code == Refused::NothingToTell);
  LONGS_EQUAL(0, found.faults.size());
}

TEST(SecondLook, AnEmptyScanIsRefused) {
  const Findings found = look_again(faulty_work().first, {}, faulty_work().line, faulty_work().plan);
  CHECK_TRUE(found.refusal && found.refusal->code == Refused::NotSeen);
}

TEST(SecondLook, AShoeThatWasMovedIsRefused) {
  cloud::PointCloud moved = faulty_work().second;
  for (Eigen::Vector3f& p : moved.points) p.x() += 1;
  const Findings found = look_again(faulty_work().first, moved, faulty_work().line, faulty_work().plan);
  CHECK_TRUE(found.refusal.has_value());
  CHECK_TRUE(found.refusal->code == Refused::ShoeMoved);
}

TEST(SecondLook, AHoleInTheSecondScanIsNotSeen) {
  cloud::PointCloud cut;
  const cloud::PointCloud& whole = faulty_work().second;
  const auto profiles = static_cast<double>(whole.profile.back());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (std::abs(whole.profile[i] / profiles - 0.5) < 0.01) continue;
    cut.points.push_back(whole.points[i]);
    cut.profile.push_back(whole.profile[i]);
    cut.amplitude.push_back(whole.amplitude[i]);
    cut.width_px.push_back(whole.width_px[i]);
  }
  const Findings found = look_again(faulty_work().first, cut, faulty_work().line, faulty_work().plan);
  CHECK_TRUE(std::ranges::any_of(found.cannot_tell, [](const CannotTell& stretch) {
    return stretch.why == Unclear::NotSeen && stretch.along.to_mm - stretch.along.from_mm > 5;
  }));
}

TEST(SecondLook, EveryRefusalHasItsRow) {
  for (const Refused code :
       {Refused::ShoeMoved, Refused::OtherShoe, Refused::NotSeen, Refused::NothingToTell})
    CHECK_TRUE(report::refusal_row(code).code == code);
  for (const Settle code : {Settle::WorkFaulty, Settle::WorkUnsure})
    CHECK_TRUE(report::refusal_row(code).code == code);
}

}  // namespace biteline::second_look
