// SPDX-License-Identifier: MIT
#include "host/records/results/view/weak_stretches.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

namespace biteline::results {
namespace {

/// An oval of 300 x 100 mm about (150, 0), 0.5 mm spaced, sure everywhere; the toe bends by `bend_mm` to the
/// left.
cloud::ClosedLine oval(double bend_mm) {
  constexpr int k_count = 1400;
  cloud::ClosedLine line;
  for (int i = 0; i < k_count; ++i) {
    const double a = 2 * std::numbers::pi * i / k_count;
    const double x_mm = 150 + 150 * std::cos(a);
    const double beyond_ball = std::max(0.0, x_mm / 300 - 0.65) / (0.935 - 0.65);
    line.points.push_back({.position = Vec3(x_mm, 50 * std::sin(a) + bend_mm * beyond_ball, 20),
                           .normal = Vec3(std::cos(a), std::sin(a), 0),
                           .tangent = Vec3(-std::sin(a), std::cos(a), 0),
                           .confidence = 0.95});
  }
  return line;
}

/// Points whose angle about the oval's middle lies within `half_deg` of `at_deg`.
void weaken(cloud::ClosedLine& line, double at_deg, double half_deg, double confidence) {
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const double a_deg = 360.0 * static_cast<double>(i) / static_cast<double>(line.points.size());
    if (std::abs(std::remainder(a_deg - at_deg, 360)) <= half_deg) line.points[i].confidence = confidence;
  }
}

}  // namespace

TEST_GROUP(WeakStretches){};

TEST(WeakStretches, SureLineHasNone) {
  LONGS_EQUAL(0, weak_stretches(oval(0), SE3::Identity()).size());
  STRCMP_EQUAL("", warning({}).c_str());
}

TEST(WeakStretches, OneOverTheFirstRowIsOneAtTheToe) {
  cloud::ClosedLine line = oval(0);
  weaken(line, 0, 3, 0.3);
  const auto stretches = weak_stretches(line, SE3::Identity());
  LONGS_EQUAL(1, stretches.size());
  STRCMP_EQUAL("toe", stretches[0].place.c_str());
  DOUBLES_EQUAL(0.3, stretches[0].least_confidence, 1e-12);
  CHECK(stretches[0].u95_is_guessed);
}

TEST(WeakStretches, PlaceIsSaidInTheShoesOwnFrame) {
  cloud::ClosedLine line = oval(0);
  weaken(line, 90, 3, 0.3);
  weaken(line, 180, 3, 0.3);
  // The shoe's heel lies at (400, 0) of the base, and it points the other way.
  const SE3 T_base_shoe = geometry::exp_se3((Twist() << 0, 0, 0, 0, 0, std::numbers::pi).finished());
  for (cloud::LinePoint& point : line.points) point.position = T_base_shoe * point.position;
  const auto stretches = weak_stretches(line, T_base_shoe);
  LONGS_EQUAL(2, stretches.size());
  STRCMP_EQUAL("left side, in the middle", stretches[0].place.c_str());
  STRCMP_EQUAL("heel", stretches[1].place.c_str());
}

TEST(WeakStretches, NeighboursLessThanThreeMillimetresApartAreOne) {
  cloud::ClosedLine line = oval(0);
  for (const std::size_t i : {100U, 101U, 104U, 130U}) line.points[i].flags = cloud::k_line_unsure;
  const auto stretches = weak_stretches(line, SE3::Identity());
  LONGS_EQUAL(2, stretches.size());
  const double spacing_mm = cloud::length_mm(line) / 1400;
  DOUBLES_EQUAL(5 * spacing_mm, stretches[0].length_mm, 1e-9);
  DOUBLES_EQUAL(100 * spacing_mm, stretches[0].from_mm, 1e-9);
  DOUBLES_EQUAL(spacing_mm, stretches[1].length_mm, 1e-9);
}

TEST(WeakStretches, LineThatIsWeakAllRoundIsOneStretch) {
  cloud::ClosedLine line = oval(0);
  weaken(line, 0, 360, 0.2);
  const auto stretches = weak_stretches(line, SE3::Identity());
  LONGS_EQUAL(1, stretches.size());
  DOUBLES_EQUAL(cloud::length_mm(line), stretches[0].length_mm, 1e-9);
}

TEST(WeakStretches, ToldU95CountsBeforeTheConfidence) {
  cloud::ClosedLine line = oval(0);
  for (cloud::LinePoint& point : line.points) point.u95_mm = 0.2;
  line.points[700].u95_mm = 1.7;
  const auto stretches = weak_stretches(line, SE3::Identity());
  LONGS_EQUAL(1, stretches.size());
  DOUBLES_EQUAL(1.7, stretches[0].u95_mm, 1e-12);
  CHECK(!stretches[0].u95_is_guessed);
}

TEST(WeakStretches, ToeBendsInwards) {
  CHECK(inner_side(oval(6), SE3::Identity()) == InnerSide::Left);
  CHECK(inner_side(oval(-6), SE3::Identity()) == InnerSide::Right);
  CHECK(inner_side(oval(0), SE3::Identity()) == InnerSide::Unknown);
}

TEST(WeakStretches, U95OfAConfidenceIsRayleighs) {
  // P(r < 0.3) = 0.95: 0.3 mm itself.
  DOUBLES_EQUAL(0.3, u95_of_confidence_mm(0.95), 1e-9);
  DOUBLES_EQUAL(0.3 * std::sqrt(std::log(0.05) / std::log(0.5)), u95_of_confidence_mm(0.5), 1e-9);
  DOUBLES_EQUAL(10, u95_of_confidence_mm(0), 1e-9);
}

}  // namespace biteline::results
