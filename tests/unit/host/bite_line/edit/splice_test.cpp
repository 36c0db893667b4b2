// SPDX-License-Identifier: MIT
#include "host/bite_line/edit/splice.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace biteline::edit {
namespace {

/// A circle of 100 mm, anticlockwise, in steps of half a millimetre.
cloud::ClosedLine circle() {
  cloud::ClosedLine line;
  constexpr std::size_t k_count = 1257;
  for (std::size_t i = 0; i < k_count; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / k_count;
    const Vec3 out{std::cos(angle), std::sin(angle), 0};
    line.points.push_back({.position = 100 * out,
                           .normal = out,
                           .tangent = Vec3{-out.y(), out.x(), 0},
                           .confidence = 0.9,
                           .u95_mm = 0.1});
  }
  return line;
}

double radius(const cloud::LinePoint& point) {
  return point.position.head<2>().norm();
}

}  // namespace

TEST_GROUP(Splice){};

TEST(Splice, ABridgeOfACircleIsTheCircleAndWhatLiesOutsideStays) {
  const cloud::ClosedLine line = circle();
  const Ends ends{.first = 100, .last = 160};
  const cloud::ClosedLine sut = splice(line, ends, bridged_stretch(line, ends));
  int mended = 0;
  double least = 1;
  for (const cloud::LinePoint& point : sut.points) {
    DOUBLES_EQUAL(100, radius(point), 0.05);
    DOUBLES_EQUAL(1, point.normal.norm(), 1e-9);
    if (point.source != cloud::PointSource::Mended) continue;
    ++mended;
    CHECK(point.u95_mm.value_or(0) >= k_hand_u95_mm);
    CHECK(point.confidence <= 0.9);
    least = std::min(least, point.confidence);
  }
  DOUBLES_EQUAL(59, mended, 1);
  CHECK(least < 0.8);  // 15 mm from either end
  for (std::size_t i = 0; i <= 100; ++i) CHECK(sut.points[i].position == line.points[i].position);
  for (std::size_t i = 160; i < line.points.size(); ++i)
    CHECK(sut.points[sut.points.size() - line.points.size() + i].position == line.points[i].position);
}

TEST(Splice, AStretchAcrossTheFirstRowIsMendedWhole) {
  const cloud::ClosedLine line = circle();
  const Ends ends{.first = line.points.size() - 30, .last = 30};
  const cloud::ClosedLine sut = splice(line, ends, bridged_stretch(line, ends));
  DOUBLES_EQUAL(cloud::length_mm(line), cloud::length_mm(sut), 0.2);
  CHECK(sut.points.front().position == line.points[30].position);
  for (std::size_t i = 0; i < sut.points.size(); ++i) {
    const Vec3 step = sut.points[(i + 1) % sut.points.size()].position - sut.points[i].position;
    DOUBLES_EQUAL(0.5, step.norm(), 0.05);
  }
}

TEST(Splice, AHandThatNoCreaseHoldsIsFollowedAndToldAsHalfAMillimetre) {
  const cloud::ClosedLine line = circle();
  cloud::ClosedLine placed = line;
  for (cloud::LinePoint& point : placed.points) point.source = cloud::PointSource::Seen;
  const Ends ends{.first = 200, .last = 320};
  const Vec3 hint = line.points[260].position * 1.03;  // 3 mm outwards
  const cloud::ClosedLine sut = splice(line, ends, led_stretch(placed, line, ends, {.hints = {&hint, 1}}));
  const cloud::LinePoint& at = sut.points[nearest_index(sut, hint)];
  DOUBLES_EQUAL(103, radius(at), 0.05);
  DOUBLES_EQUAL(k_hand_u95_mm, at.u95_mm.value_or(0), 1e-9);
  CHECK(at.source == cloud::PointSource::Mended);
}

TEST(Splice, AMeasuredCreaseNearTheHandHoldsTheLine) {
  const cloud::ClosedLine line = circle();
  const Ends ends{.first = 200, .last = 320};
  const Vec3 hint = line.points[260].position * 1.01;  // 1 mm outwards
  const cloud::ClosedLine sut = splice(line, ends, led_stretch(line, line, ends, {.hints = {&hint, 1}}));
  const cloud::LinePoint& at = sut.points[nearest_index(sut, hint)];
  DOUBLES_EQUAL(100, radius(at), 0.01);
  DOUBLES_EQUAL(0.1, at.u95_mm.value_or(0), 1e-9);
}

TEST(Splice, WhatBecameOfAPointIsTold) {
  const cloud::ClosedLine line = circle();
  const Ends ends{.first = 200, .last = 320};
  const std::vector<Vec3> hints{line.points[240].position * 1.01, line.points[280].position * 1.03};
  std::vector<Snap> snaps;
  static_cast<void>(led_stretch(line, line, ends, {.hints = hints}, &snaps));
  LONGS_EQUAL(2, snaps.size());
  CHECK(snaps[0].on_crease);  // 1 mm beside it
  DOUBLES_EQUAL(1.0, snaps[0].by_mm, 0.02);
  CHECK_FALSE(snaps[1].on_crease);  // 3 mm: the line leads through it
  DOUBLES_EQUAL(0, snaps[1].by_mm, 1e-12);
}

TEST(Splice, AHandVouchesForWhatItHasChosenAndForWhatLiesNearAPoint) {
  cloud::ClosedLine line = circle();
  for (cloud::LinePoint& point : line.points) {
    point.source = cloud::PointSource::Bridged;
    point.confidence = 0.1;
    point.u95_mm = 3;
    cloud::flag_unsure(point);
  }
  const Ends ends{.first = 100, .last = 900};
  const Vec3 hint = line.points[500].position;
  const auto by_hand = [](const cloud::LinePoint& point) {
    return point.source == cloud::PointSource::Mended && point.u95_mm == k_hand_u95_mm &&
           point.confidence == k_hand_confidence && point.flags == 0;
  };
  const std::vector<cloud::LinePoint> led = led_stretch(line, line, ends, {.hints = {&hint, 1}});
  CHECK(by_hand(led[400]));
  CHECK_FALSE(by_hand(led[200]));
  const std::vector<cloud::LinePoint> chosen = led_stretch(line, line, ends, {.chosen = true});
  for (std::size_t i = 1; i + 1 < chosen.size(); ++i) CHECK(by_hand(chosen[i]));
}

TEST(Splice, AHandIsNoWorseThanTheCreaseThatItLiesOn) {
  cloud::LinePoint sharp{.position = Vec3::Zero(),
                         .normal = Vec3::UnitX(),
                         .tangent = Vec3::UnitY(),
                         .confidence = 0.97,
                         .u95_mm = 0.08};
  mark_by_hand(sharp);
  DOUBLES_EQUAL(0.97, sharp.confidence, 1e-12);
  DOUBLES_EQUAL(0.08, sharp.u95_mm.value_or(9), 1e-12);
  cloud::LinePoint dull{.position = Vec3::Zero(),
                        .normal = Vec3::UnitX(),
                        .tangent = Vec3::UnitY(),
                        .confidence = 0.2,
                        .u95_mm = 2.5};
  mark_by_hand(dull);
  DOUBLES_EQUAL(k_hand_confidence, dull.confidence, 1e-12);
  DOUBLES_EQUAL(k_hand_u95_mm, dull.u95_mm.value_or(9), 1e-12);
  LONGS_EQUAL(0, dull.flags);
}

TEST(Splice, WhatNoPersonHasLookedAtIsNoSurerThanWhatItReplaces) {
  cloud::LinePoint point{.position = Vec3::Zero(),
                         .normal = Vec3::UnitX(),
                         .tangent = Vec3::UnitY(),
                         .confidence = 0.99,
                         .u95_mm = 0.02};
  const cloud::LinePoint before{
      .position = Vec3::Zero(), .normal = Vec3::UnitX(), .tangent = Vec3::UnitY(), .confidence = 0.3};
  mark_mended(point, before);
  DOUBLES_EQUAL(0.3, point.confidence, 1e-12);
  CHECK((point.flags & cloud::k_line_unsure) != 0);
  DOUBLES_EQUAL(0.02, point.u95_mm.value_or(9), 1e-12);  // a measured crease
}

}  // namespace biteline::edit
