// SPDX-License-Identifier: MIT
// Found lines of made shoes, spoiled and mended again.
#include "host/bite_line/edit/edit.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/bite_line/edit/splice.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "tests/support/made_cloud.hpp"
#include "tests/support/refusals.hpp"
#include "tests/unit/host/bite_line/guard_shoes.hpp"

namespace biteline::edit {
namespace {

const test::MadeCloud& shoe() {
  static const test::MadeCloud made = test::made_cloud(sim::ShoeClass::Deep, 41, test::somewhere());
  return made;
}
const Surface& surface() {
  static const Surface prepared = std::move(Surface::of(shoe().cloud).value());
  return prepared;
}
const cloud::ClosedLine& found() {
  static const cloud::ClosedLine line = bite_line::find_bite_line(shoe().cloud, {}).line;
  return line;
}

/// The found line, 4 mm too high from `from` on over `count` points.
cloud::ClosedLine spoiled(std::size_t from, std::size_t count) {
  cloud::ClosedLine line = found();
  for (std::size_t k = 0; k < count; ++k) {
    cloud::LinePoint& point = line.points[from + k];
    point.position.z() +=
        4 * std::pow(std::sin(3.14159265 * static_cast<double>(k) / static_cast<double>(count)), 2);
    point.confidence = 0.4;
  }
  return line;
}

double most_mm(const cloud::ClosedLine& line) {
  double most = 0;
  for (const cloud::LinePoint& point : line.points)
    most = std::max(most, test::distance_mm(point.position, shoe().truth));
  return most;
}

double mm_of(const cloud::ClosedLine& line, std::size_t point) {
  double mm = 0;
  for (std::size_t i = 0; i < point; ++i)
    mm += (line.points[i + 1].position - line.points[i].position).norm();
  return mm;
}

}  // namespace

TEST_GROUP(Mend){};

TEST(Mend, EveryCodeHasItsRow) {
  test::check_refusal_table(Refused::ScanUnusable);
}

TEST(Mend, AStretchThatWentAstrayIsLedBackOntoTheCreaseByOnePoint) {
  const cloud::ClosedLine wrong = spoiled(300, 100);
  CHECK(most_mm(wrong) > 2.5);
  const Step step{.kind = Step::Kind::Through,
                  .stretch = {.from_mm = mm_of(wrong, 290), .to_mm = mm_of(wrong, 410)},
                  .points = {found().points[350].position}};
  const OrRefusal<cloud::ClosedLine> sut = mend(surface(), wrong, {&step, 1}, {});
  CHECK_TEXT(sut.has_value(), sut ? "" : sut.error().reason.c_str());
  CHECK(most_mm(*sut) < 0.3);
  // As good as it was found: it was placed in the raw points again.
  DOUBLES_EQUAL(test::mean_error_mm(found(), shoe().truth), test::mean_error_mm(*sut, shoe().truth), 0.01);
  int mended = 0;
  for (const cloud::LinePoint& point : sut->points) {
    if (point.source != cloud::PointSource::Mended) continue;
    ++mended;
    CHECK(point.u95_mm.value_or(9) < k_hand_u95_mm);  // snapped
  }
  CHECK(mended > 100);
  for (std::size_t i = 0; i < 280; ++i) CHECK(sut->points[i].position == wrong.points[i].position);
}

TEST(Mend, AHandsWordCountsForMoreThanTheDoubtThatItReplaces) {
  const cloud::ClosedLine wrong = spoiled(300, 100);
  const Step step{.kind = Step::Kind::Through,
                  .stretch = {.from_mm = mm_of(wrong, 305), .to_mm = mm_of(wrong, 395)},
                  .points = {found().points[350].position}};
  const OrRefusal<cloud::ClosedLine> sut = mend(surface(), wrong, {&step, 1}, {});
  CHECK(sut.has_value());
  for (const cloud::LinePoint& point : sut->points) {
    if (point.source == cloud::PointSource::Mended) CHECK(point.confidence >= k_hand_confidence);
  }
}

TEST(Mend, WhatTheHeadMayBeOffByIsInAMendedPlaceToo) {
  cloud::ClosedLine base = spoiled(300, 100);
  for (cloud::LinePoint& point : base.points) point.u95_mm = 0.8;
  base.points[350].u95_mm = 0.01;  // off the line that was found: it tells nothing
  const Step step{.kind = Step::Kind::Through,
                  .stretch = {.from_mm = mm_of(base, 290), .to_mm = mm_of(base, 410)},
                  .points = {found().points[350].position}};
  const OrRefusal<cloud::ClosedLine> sut = mend(surface(), base, {&step, 1}, {});
  CHECK(sut.has_value());
  for (const cloud::LinePoint& point : sut->points)
    if (point.source == cloud::PointSource::Mended) DOUBLES_EQUAL(0.8, point.u95_mm.value_or(9), 1e-9);
}

TEST(Mend, ACutTakesOutTheBulge) {
  const cloud::ClosedLine wrong = spoiled(500, 40);
  const Step step{.kind = Step::Kind::Cut,
                  .stretch = {.from_mm = mm_of(wrong, 498), .to_mm = mm_of(wrong, 542)}};
  const OrRefusal<cloud::ClosedLine> sut = mend(surface(), wrong, {&step, 1}, {});
  CHECK(sut.has_value());
  CHECK(most_mm(*sut) < 0.6 * most_mm(wrong));
  for (const cloud::LinePoint& point : sut->points) {
    if (point.source == cloud::PointSource::Mended) CHECK(point.u95_mm.value_or(0) >= k_hand_u95_mm);
  }
}

TEST(Mend, TheFirstCandidateIsTheFoundLine) {
  const Step step{.kind = Step::Kind::Candidate, .candidate = 1};
  const OrRefusal<cloud::ClosedLine> sut = mend(surface(), found(), {&step, 1}, {});
  CHECK(sut.has_value());
  DOUBLES_EQUAL(0, test::mean_error_mm(*sut, shoe().truth), 0.08);
  for (const cloud::LinePoint& point : sut->points) CHECK(point.source != cloud::PointSource::Mended);
}

TEST(Mend, ACandidateOfARefusedScanIsByHandAndAModelMakesItNoSurer) {
  const Step step{.kind = Step::Kind::Candidate, .candidate = 1};
  const test::MadeCloud bare = test::made_cloud(sim::ShoeClass::Bare, 43, test::somewhere());
  const OrRefusal<Surface> upper = Surface::of(bare.cloud);
  CHECK(upper.has_value());
  const OrRefusal<cloud::ClosedLine> sut = mend(*upper, {}, {&step, 1}, {});
  CHECK(sut.has_value());
  for (const cloud::LinePoint& point : sut->points) {
    CHECK(point.confidence >= k_hand_confidence);
    CHECK(point.u95_mm.value_or(9) <= k_hand_u95_mm);
    LONGS_EQUAL(0, point.flags);
    CHECK(point.source == cloud::PointSource::Mended);
  }
  const OrRefusal<cloud::ClosedLine> by_model = mend(*upper, {}, {&step, 1}, {}, By::Model);
  CHECK(by_model.has_value());
  for (const cloud::LinePoint& point : by_model->points) {
    CHECK(point.confidence <= upper->decision().confidence);
    CHECK((point.flags & cloud::k_line_unsure) != 0);
  }
}

/// What the head leaves open a hand cannot settle.
TEST(Mend, NoPointIsSurerThanTheSurestPlaceOfTheLineThatIsMended) {
  cloud::ClosedLine base = found();
  for (cloud::LinePoint& point : base.points) {
    point.u95_mm = 0.8;
    point.confidence = 1e-16;
    cloud::flag_unsure(point);
  }
  base.points[10].u95_mm = 0.7;
  const Step step{.kind = Step::Kind::Candidate, .candidate = 1};
  const OrRefusal<cloud::ClosedLine> sut = mend(surface(), base, {&step, 1}, {});
  CHECK(sut.has_value());
  for (const cloud::LinePoint& point : sut->points) DOUBLES_EQUAL(0.7, point.u95_mm.value_or(0), 1e-12);
}

TEST(Mend, ACandidateIsTakenOverAStretchAloneAndSettlesIt) {
  cloud::ClosedLine doubted = found();
  for (std::size_t i = 300; i < 460; ++i) {
    doubted.points[i].confidence = 0.1;
    cloud::flag_unsure(doubted.points[i]);
  }
  const Step step{.kind = Step::Kind::Candidate,
                  .candidate = 1,
                  .stretch = {.from_mm = mm_of(doubted, 298), .to_mm = mm_of(doubted, 462)}};
  const OrRefusal<cloud::ClosedLine> sut = mend(surface(), doubted, {&step, 1}, {});
  CHECK_TEXT(sut.has_value(), sut ? "" : sut.error().reason.c_str());
  for (const cloud::LinePoint& point : sut->points) LONGS_EQUAL(0, point.flags);
  DOUBLES_EQUAL(test::mean_error_mm(found(), shoe().truth), test::mean_error_mm(*sut, shoe().truth), 0.01);
  CHECK(sut->points[200].source != cloud::PointSource::Mended);
  CHECK(sut->points[380].source == cloud::PointSource::Mended);
}

TEST(Mend, AllOfALineThatWasDoubtedIsSettledByItsOwnCandidate) {
  cloud::ClosedLine doubted = found();
  for (cloud::LinePoint& point : doubted.points) {
    point.confidence = 1e-16;
    cloud::flag_unsure(point);
  }
  const Step step{.kind = Step::Kind::Candidate, .candidate = 1};
  const OrRefusal<cloud::ClosedLine> sut = mend(surface(), doubted, {&step, 1}, {});
  CHECK(sut.has_value());
  for (const cloud::LinePoint& point : sut->points) {
    CHECK(point.source == cloud::PointSource::Mended);
    CHECK(point.confidence >= k_hand_confidence);
    LONGS_EQUAL(0, point.flags);
  }
}

TEST(Mend, AnOlderVersionComesBack) {
  const Step step{.kind = Step::Kind::BackTo, .line_version = 0};
  const OldLine old_line = [](int version) {
    return version == 0 ? std::optional{found()} : std::optional<cloud::ClosedLine>{};
  };
  const OrRefusal<cloud::ClosedLine> sut = mend(surface(), spoiled(300, 100), {&step, 1}, old_line);
  CHECK(sut.has_value());
  CHECK(sut->points[350].position == found().points[350].position);
  const Step unknown{.kind = Step::Kind::BackTo, .line_version = 7};
  CHECK(mend(surface(), found(), {&unknown, 1}, old_line).error().code == Refused::NoSuchVersion);
}

TEST(Mend, WhatCannotBeDoneIsRefusedByName) {
  const auto code_of = [](const Step& step, const cloud::ClosedLine& base) {
    const OrRefusal<cloud::ClosedLine> sut = mend(surface(), base, {&step, 1}, {});
    CHECK_FALSE(sut.has_value());
    return sut.error().code;
  };
  const double all_mm = cloud::length_mm(found());
  const Stretch short_one{.from_mm = 10, .to_mm = 11};
  const Stretch right{.from_mm = 20, .to_mm = 80};
  CHECK(code_of({.kind = Step::Kind::Candidate, .candidate = 99}, found()) == Refused::NoSuchCandidate);
  CHECK(code_of({.kind = Step::Kind::Cut, .stretch = short_one}, found()) == Refused::BadStretch);
  CHECK(code_of({.kind = Step::Kind::Cut, .stretch = {.from_mm = 10, .to_mm = 10 + 0.6 * all_mm}}, found()) ==
        Refused::BadStretch);
  CHECK(code_of({.kind = Step::Kind::Cut, .stretch = {.from_mm = 10, .to_mm = 1e9}}, found()) ==
        Refused::BadStretch);
  CHECK(code_of({.kind = Step::Kind::Cut, .stretch = right}, {}) == Refused::NoLine);
  CHECK(code_of({.kind = Step::Kind::Through, .stretch = right, .points = {Vec3{0, 0, 5000}}}, found()) ==
        Refused::HintOffSide);
  CHECK(code_of({.kind = Step::Kind::Through, .stretch = right, .points = {found().points[600].position}},
                found()) == Refused::HintOutside);
}

TEST(Mend, ALineIsLedRoundAGuardByAFewPoints) {
  // The found line goes round the guard; below it a bridge is put in its place.
  const test::SweepScan guarded = test::scan_of(test::with_guard(test::designed(0)));
  const cloud::ClosedLine line = bite_line::find_bite_line(guarded.cloud, {}).line;
  const Surface side = std::move(Surface::of(guarded.cloud).value());
  // The guard's edge stands upright over its flanks: the line is steepest there.
  const std::size_t count = line.points.size();
  const auto steep_at = [&](std::size_t i) {
    const Vec3 way = line.points[(i + 10) % count].position - line.points[i].position;
    return std::abs(way.z()) > 1.5 * way.head<2>().norm();
  };
  std::vector<std::size_t> steep;
  for (std::size_t i = 0; i < count; ++i)
    if (steep_at(i)) steep.push_back(i);
  CHECK(steep.size() > 10);
  CHECK(steep.back() - steep.front() < count / 2);
  const std::size_t from = steep.front() - 30, to = steep.back() + 40;
  const Step cut{.kind = Step::Kind::Cut,
                 .stretch = {.from_mm = mm_of(line, from), .to_mm = mm_of(line, to)}};
  const OrRefusal<cloud::ClosedLine> wrong = mend(side, line, {&cut, 1}, {});
  CHECK_TEXT(wrong.has_value(), wrong ? "" : wrong.error().reason.c_str());
  const auto most_off_mm = [&](const cloud::ClosedLine& of) {
    double most = 0;
    for (std::size_t i = from; i <= to; ++i)
      most = std::max(most, test::distance_mm(line.points[i].position, of));
    return most;
  };
  CHECK(most_off_mm(*wrong) > 3);
  const std::size_t first = nearest_index(*wrong, line.points[from].position);
  const std::size_t last = nearest_index(*wrong, line.points[to].position);
  const Step through{.kind = Step::Kind::Through,
                     .stretch = {.from_mm = mm_of(*wrong, first - 4), .to_mm = mm_of(*wrong, last + 4)},
                     .points = {line.points[(from + to) / 2].position, line.points[steep.back() - 4].position,
                                line.points[steep.front() + 8].position}};
  const OrRefusal<cloud::ClosedLine> sut = mend(side, *wrong, {&through, 1}, {});
  CHECK_TEXT(sut.has_value(), sut ? "" : sut.error().reason.c_str());
  CHECK_COMPARE(most_off_mm(*sut), <, 1.0);
}

TEST(Mend, AStretchAboutAPointHoldsIt) {
  const Vec3 point = found().points[400].position;
  const Stretch sut = stretch_about(found(), {&point, 1});
  DOUBLES_EQUAL(mm_of(found(), 400) - 20, sut.from_mm, 0.6);
  DOUBLES_EQUAL(mm_of(found(), 400) + 20, sut.to_mm, 0.6);
  const Vec3 start = found().points[0].position;
  const Stretch across = stretch_about(found(), {&start, 1});
  CHECK(across.from_mm > across.to_mm);
}

}  // namespace biteline::edit
