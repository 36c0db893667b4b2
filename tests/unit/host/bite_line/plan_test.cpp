// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/bite_line/shoe/plan.hpp"

namespace biteline::bite_line {
namespace {

std::vector<Vec2> ellipse(double a_mm, double b_mm, const Vec2& centre) {
  std::vector<Vec2> curve;
  for (int i = 0; i < 720; ++i) {
    const double t = 2 * std::numbers::pi * i / 720;
    curve.push_back(centre + Vec2{a_mm * std::cos(t), b_mm * std::sin(t)});
  }
  return curve;
}

}  // namespace

TEST_GROUP(Plan){};

TEST(Plan, HullOfASquareWithPointsInsideIsItsCorners) {
  std::vector<Vec2> points{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}, {2, 0}, {1, 3}};
  const std::vector<Vec2> sut = convex_hull(points);
  LONGS_EQUAL(4, sut.size());
  double area = 0;
  for (std::size_t i = 0; i < 4; ++i)
    area += 0.5 * (sut[i].x() * sut[(i + 1) % 4].y() - sut[i].y() * sut[(i + 1) % 4].x());
  DOUBLES_EQUAL(16.0, area, 1e-12);  // positive: anticlockwise
}

TEST(Plan, TightestBoxFindsATurnedRectangle) {
  const double angle = 0.6;
  const Vec2 along{std::cos(angle), std::sin(angle)};
  const Vec2 across{-along.y(), along.x()};
  std::vector<Vec2> points;
  for (const auto& [u, v] : {std::pair{-5.0, -2.0}, {5.0, -2.0}, {5.0, 2.0}, {-5.0, 2.0}})
    points.push_back(Vec2{7, -3} + u * along + v * across);
  const PlanBox sut = tightest_box(convex_hull(points));
  DOUBLES_EQUAL(10.0, sut.length_mm, 1e-9);
  DOUBLES_EQUAL(4.0, sut.width_mm, 1e-9);
  DOUBLES_EQUAL(1.0, std::abs(sut.long_axis.dot(along)), 1e-9);
  DOUBLES_EQUAL(0.0, (sut.centre - Vec2{7, -3}).norm(), 1e-9);
}

TEST(Plan, LocateUndoesPointPlusOffset) {
  const Outline sut{ellipse(140, 50, {30, -20}), {.smoothing_mm = 0}};
  std::mt19937 random{9};
  std::uniform_real_distribution<double> s_any{0, sut.length_mm()};
  std::uniform_real_distribution<double> o_any{-8, 12};  // the ellipse's tightest bend has a radius of 18 mm
  std::vector<OutlinePlace> truth;
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 500; ++i) {
    const double s = s_any(random);
    const double o = o_any(random);
    const Vec2 p = sut.point(s) + o * sut.normal(s);
    truth.push_back({static_cast<float>(s), static_cast<float>(o), static_cast<float>(i)});
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(i));
  }
  std::vector<OutlinePlace> places(points.size());
  sut.locate(points, places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double ds = std::abs(static_cast<double>(places[i].s_mm - truth[i].s_mm));
    // One Newton step from a sample at most half a millimetre away.
    DOUBLES_EQUAL(0.0, std::min(ds, sut.length_mm() - ds), 0.02);
    DOUBLES_EQUAL(truth[i].o_mm, places[i].o_mm, 0.02);
    LONGS_EQUAL(i, std::lround(places[i].z_mm));
    // One point alone, and those that fill no vector, have the same place.
    DOUBLES_EQUAL(places[i].s_mm, sut.locate(points[i]).s_mm, 1e-4);
  }
}

TEST(Plan, NormalsPointOutwardsAndTheLengthIsTheEllipses) {
  const Outline sut{ellipse(140, 50, {0, 0}), {.smoothing_mm = 0}};
  DOUBLES_EQUAL(630.4, sut.length_mm(), 0.5);  // Ramanujan's second formula
  for (double s = 0; s < sut.length_mm(); s += 7) CHECK(sut.normal(s).dot(sut.point(s)) > 0);
  DOUBLES_EQUAL(140.0 / (50.0 * 50.0), sut.bend_per_mm(0), 0.002);  // at the ellipse's end, a / b^2
}

TEST(Plan, FarPlacesHaveNoFoot) {
  const Outline sut{ellipse(140, 50, {0, 0}), {}};
  CHECK(sut.locate({500, 0, 0}).s_mm < 0);
  CHECK(sut.locate({0, -200, 0}).s_mm < 0);
}

}  // namespace biteline::bite_line
