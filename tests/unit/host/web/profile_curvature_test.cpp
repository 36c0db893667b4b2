// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/profile_curvature.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::web {
namespace {

/// A point every 0.2 mm along a circle of this radius, 200 mm away from the camera; a groove bends towards it
/// at its ends, a bead away from it.
std::vector<profile::ProfilePoint> arc(float radius_mm, bool groove) {
  std::vector<profile::ProfilePoint> points;
  for (int i = -30; i <= 30; ++i) {
    const float at = 0.2F * static_cast<float>(i) / radius_mm;
    const float rise_mm = radius_mm * (1 - std::cos(at));
    profile::ProfilePoint point;
    point.point_cam = {radius_mm * std::sin(at), 0, 200 + (groove ? -rise_mm : rise_mm)};
    points.push_back(point);
  }
  return points;
}

}  // namespace

TEST_GROUP(ProfileCurvature){};

TEST(ProfileCurvature, OfACircleItIsOneOverTheRadiusAndConcaveIsPositive) {
  // Chords of some 2 mm: three points of a circle give it exactly.
  DOUBLES_EQUAL(0.1, profile_curvature(arc(10, true))[30], 1e-4);
  DOUBLES_EQUAL(-0.1, profile_curvature(arc(10, false))[30], 1e-4);
  DOUBLES_EQUAL(0, profile_curvature(arc(1e5F, true))[30], 1e-4);
}

TEST(ProfileCurvature, NobodyKnowsItAtAnEndBesideAGapAndWhereNoSurfaceIs) {
  std::vector<profile::ProfilePoint> points = arc(10, true);
  points[20].flags = profile::k_point_reflection;
  std::vector<float> curvature = profile_curvature(points);
  CHECK(std::isnan(curvature.front()));
  CHECK(std::isnan(curvature.back()));
  CHECK(std::isnan(curvature[20]));
  CHECK(!std::isnan(curvature[19]));
  points.erase(points.begin() + 31, points.begin() + 55);  // 4.8 mm
  CHECK(std::isnan(profile_curvature(points)[30]));
  CHECK(profile_curvature({}).empty());
}

}  // namespace biteline::web
