// SPDX-License-Identifier: MIT
#include "host/intake/capture/advice.hpp"

#include <CppUTest/TestHarness.h>

#include <numbers>

namespace biteline::capture {
namespace {

constexpr double k_degree = std::numbers::pi / 180;

calibration::PlaneView view_at(std::initializer_list<Vec2> pixels) {
  calibration::PlaneView view;
  for (const Vec2& pixel : pixels) view.centres.push_back({.pixel_px = pixel});
  return view;
}

SE3 turned(const Vec3& vector_deg) {
  return geometry::make_se3(Eigen::Quaterniond(geometry::exp_so3(k_degree * vector_deg)), {0, 0, 200});
}

}  // namespace

TEST_GROUP(CaptureAdvice) {
  calibration::PictureSize size{.width_px = 900, .height_px = 600};
};

TEST(CaptureAdvice, TheFieldThatSawNothingIsWantedCornersFirst) {
  const std::vector<calibration::PlaneView> middle{view_at({{450, 300}, {450, 100}})};
  LONGS_EQUAL(2, coverage_of(middle, size).count());
  STRCMP_EQUAL("upper left corner", missing_field(coverage_of(middle, size)).c_str());
  std::vector<calibration::PlaneView> most{
      view_at({{100, 100}, {800, 100}, {100, 500}, {450, 300}, {450, 100}})};
  STRCMP_EQUAL("lower right corner", missing_field(coverage_of(most, size)).c_str());
  most.push_back(view_at({{899.9, 599.9}, {100, 300}, {800, 300}}));
  STRCMP_EQUAL("lower edge", missing_field(coverage_of(most, size)).c_str());
  most.push_back(view_at({{450, 600}}));  // on the border: no place outside
  CHECK(missing_field(coverage_of(most, size)).empty());
}

TEST(CaptureAdvice, TheTiltThatIsMissingIsToldByTheEdgeThatGoesAway) {
  // About the picture's downward axis, positive: x turns away from the viewer, so the right edge goes away...
  const SE3 right_away = turned({0, -20, 0});
  CHECK((right_away * Vec3(50, 0, 0)).z() > (right_away * Vec3(-50, 0, 0)).z());
  STRCMP_CONTAINS("left edge", missing_tilt({right_away}).c_str());
  const SE3 left_away = turned({0, 20, 0}), down_away = turned({20, 0, 0}), up_away = turned({-20, 0, 0});
  CHECK((down_away * Vec3(0, 50, 0)).z() > (down_away * Vec3(0, -50, 0)).z());
  STRCMP_CONTAINS("right edge", missing_tilt({left_away}).c_str());
  STRCMP_CONTAINS("upper edge", missing_tilt({left_away, right_away, down_away}).c_str());
  STRCMP_CONTAINS("lower edge", missing_tilt({left_away, right_away, up_away}).c_str());
  CHECK(missing_tilt({left_away, right_away, up_away, down_away}).empty());
  // Slight ones do not count.
  STRCMP_CONTAINS("left edge", missing_tilt({turned({0, 8, 0})}).c_str());
}

TEST(CaptureAdvice, TheStripeIsWantedNearAndFar) {
  STRCMP_CONTAINS("upper third", missing_depth({300}, 600).c_str());
  STRCMP_CONTAINS("lower third", missing_depth({300, 10}, 600).c_str());
  CHECK(missing_depth({300, 10, 590}, 600).empty());
}

TEST(CaptureAdvice, TheHeadIsToTurnFarAndAboutTwoAxes) {
  STRCMP_CONTAINS("any axis", missing_turn({turned({0, 0, 0})}).c_str());
  STRCMP_CONTAINS("farther", missing_turn({turned({0, 0, 0}), turned({0, 10, 0})}).c_str());
  STRCMP_CONTAINS("another axis",
                  missing_turn({turned({0, 0, 0}), turned({0, 40, 0}), turned({0, -30, 0})}).c_str());
  CHECK(missing_turn({turned({0, 0, 0}), turned({0, 40, 0}), turned({30, 0, 0})}).empty());
}

}  // namespace biteline::capture
