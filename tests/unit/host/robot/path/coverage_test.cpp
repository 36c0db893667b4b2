// SPDX-License-Identifier: MIT
#include "host/robot/path/coverage.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

namespace biteline::path {
namespace {

constexpr double k_rad_per_deg = std::numbers::pi / 180;

/// Of places `step_mm` apart on a plane through the x axis, turned by `slope_rad` about it.
std::vector<Eigen::Vector3f> plane(double slope_rad, double step_mm = 0.25) {
  std::vector<Eigen::Vector3f> points;
  for (double x = -5; x <= 105; x += step_mm)
    for (double way = -30; way <= 30; way += step_mm)
      points.push_back(Vec3{x, way * std::cos(slope_rad), way * std::sin(slope_rad)}.cast<float>());
  return points;
}

/// Along x, the tool from above, its tip so far up.
PlannedPath straight(double standoff_mm) {
  PlannedPath path;
  path.motion.spacing_mm = 2;
  path.standoff_mm = standoff_mm;
  for (double x = 0; x <= 100; x += 2) {
    Waypoint w;
    w.T_base_tcp = SE3::Identity();
    w.arc_mm = x;
    w.line_base = Vec3{x, 0, 0};
    w.T_base_tcp.linear() = Eigen::AngleAxisd{std::numbers::pi, Vec3::UnitX()}.toRotationMatrix();
    w.T_base_tcp.translation() = Vec3{x, 0, standoff_mm};
    path.waypoints.push_back(w);
  }
  return path;
}

}  // namespace

TEST_GROUP(CoveredSurface){};

/// The law of sines: from the tip at a distance s the edges of a fan of half the angle a lie at
/// s sin(a) / cos(a +- b) on a plane turned by b.
TEST(CoveredSurface, AFansWidthOnASlopeIsTheLawOfSines) {
  const double half_rad = 7 * k_rad_per_deg, standoff_mm = 60;
  for (const double slope_rad : {0.0, 20 * k_rad_per_deg, 40 * k_rad_per_deg}) {
    const double truth_mm = standoff_mm * std::sin(half_rad) *
                            (1 / std::cos(half_rad + slope_rad) + 1 / std::cos(half_rad - slope_rad));
    const CoveredSurface sut =
        covered_surface(straight(standoff_mm), {.cone_rad = 2 * half_rad}, plane(slope_rad));
    LONGS_EQUAL(51, sut.sections.size());
    for (const CoveredSection& section : sut.sections) DOUBLES_EQUAL(truth_mm, section.width_mm, 0.5);
  }
}

TEST(CoveredSurface, AContactCoversItsWidthWhereItIsAndNothingElse) {
  const std::vector<Eigen::Vector3f> points = plane(0);
  const CoveredSurface sut = covered_surface(straight(0), {.contact_width_mm = 10}, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double aside_mm = std::abs(points[i].y());
    if (points[i].x() > 1 && points[i].x() < 99 && aside_mm < 4.9) LONGS_EQUAL(1, sut.times[i]);
    if (aside_mm > 5.1) LONGS_EQUAL(0, sut.times[i]);
  }
}

/// Whichever way the tool stands, it lies against the surface.
TEST(CoveredSurface, AContactIsAsWideOnASlope) {
  for (const double slope_rad : {0.0, 30 * k_rad_per_deg, 60 * k_rad_per_deg})
    for (const CoveredSection& section :
         covered_surface(straight(0), {.contact_width_mm = 12}, plane(slope_rad)).sections)
      DOUBLES_EQUAL(12, section.width_mm, 0.6);
}

TEST(CoveredSurface, WhatLiesBehindASurfaceIsNotMet) {
  std::vector<Eigen::Vector3f> points = plane(0);
  const std::size_t front = points.size();
  for (std::size_t i = 0; i < front; ++i) points.emplace_back(points[i] - Eigen::Vector3f{0, 0, 6});
  const CoveredSurface sut = covered_surface(straight(60), {.cone_rad = 0.25}, points);
  for (std::size_t i = front; i < points.size(); ++i) LONGS_EQUAL(0, sut.times[i]);
}

TEST(CoveredSurface, OverAgainIsTwice) {
  PlannedPath path = straight(0);
  for (std::size_t i = 0; i <= 10; ++i) path.waypoints.push_back(path.waypoints[i]);
  const std::vector<Eigen::Vector3f> points = plane(0);
  const CoveredSurface sut = covered_surface(path, {.contact_width_mm = 10}, points);
  std::size_t twice = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].x() > 30 && points[i].x() < 90) CHECK(sut.times[i] <= 1);
    if (points[i].x() > 5 && points[i].x() < 15 && std::abs(points[i].y()) < 4) twice += sut.times[i] == 2;
  }
  CHECK(twice > 1000);
}

TEST(CoveredSurface, AProcessWithoutAWidthCoversNothing) {
  CHECK(covered_surface(straight(0), {}, plane(0)).sections.empty());
}

}  // namespace biteline::path
