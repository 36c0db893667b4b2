// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/made_cloud.hpp"
#include "tests/unit/host/bite_line/drum.hpp"

namespace biteline::bite_line {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// The egg's wall at some place and yaw; its lower edge lies 4 mm above the table.
Points wall_in_base(const SE3& T_base_shoe) {
  Points points =
      test::drum_points(test::egg_outline(), [](double, double) { return 0.0; }, {.s_mm = 1.0, .z_mm = 0.5});
  for (Eigen::Vector3f& p : points) p = (T_base_shoe * (p.cast<double>() + Vec3{0, 0, 4})).cast<float>();
  return points;
}

void add_table(Points& points, const SE3& T_base_shoe) {
  for (double x = -100; x <= 380; x += 1.5) {
    for (double y = -150; y <= 150; y += 1.5) points.push_back((T_base_shoe * Vec3{x, y, 0}).cast<float>());
  }
}

double angle_deg(const SE3& a, const SE3& b) {
  return Eigen::AngleAxisd{a.linear().transpose() * b.linear()}.angle() * 180 / std::numbers::pi;
}

}  // namespace

TEST_GROUP(FindShoe){};

TEST(FindShoe, AxesRunFromTheHeelToTheWiderToeWhateverTheYaw) {
  for (const double yaw_rad : {0.0, 0.4, 2.1, -2.8}) {
    SE3 T_base_shoe = biteline::test::somewhere();
    T_base_shoe.linear() = Eigen::AngleAxisd{yaw_rad, Vec3::UnitZ()}.toRotationMatrix();
    const auto sut = find_shoe(wall_in_base(T_base_shoe));
    CHECK(sut.has_value());
    // Half a cell of 4 mm: axes and size come from the cells' means.
    DOUBLES_EQUAL(280, sut->length_mm, 4);
    DOUBLES_EQUAL(90, sut->width_mm, 4);
    CHECK_COMPARE(angle_deg(T_base_shoe, sut->T_base_shoe), <, 1.5);
    CHECK_COMPARE((sut->T_base_shoe.translation() - T_base_shoe * Vec3{0, 0, 4}).norm(), <, 4.0);
  }
}

TEST(FindShoe, TheTableIsLeftOutAndGivesTheTilt) {
  SE3 T_base_shoe = biteline::test::somewhere();
  T_base_shoe.linear() = T_base_shoe.linear() * Eigen::AngleAxisd{0.1, Vec3::UnitX()}.toRotationMatrix();
  Points points = wall_in_base(T_base_shoe);
  const std::size_t of_wall = points.size();
  add_table(points, T_base_shoe);
  const auto sut = find_shoe(points);
  CHECK(sut.has_value());
  CHECK_COMPARE(angle_deg(T_base_shoe, sut->T_base_shoe), <, 1.5);
  CHECK_COMPARE(sut->points.size(), >, of_wall * 95 / 100);
  for (const std::uint32_t i : sut->index) CHECK(i < of_wall);
}

TEST(FindShoe, AShankThatClimbsToAHeelDoesNotTiltTheShoe) {
  const Outline egg = test::egg_outline();
  // A heel block to x = 60, then a shank that comes down from 20 mm to the ball at 175.
  const auto bottom_mm = [&](double s) {
    const double x = egg.point(s).x();
    return x < 60 || x > 175 ? 0.0 : 20 * (175 - x) / 115;
  };
  const Points points =
      test::drum_points(egg, [&](double s, double z) { return z < bottom_mm(s) ? test::k_no_point : 0.0; },
                        {.s_mm = 1.0, .z_mm = 0.5});
  const auto sut = find_shoe(points);
  CHECK(sut.has_value());
  CHECK_COMPARE(angle_deg(SE3::Identity(), sut->T_base_shoe), <, 1.5);
}

TEST(FindShoe, PointsFarAwayAndASecondThingBesideAreNotTheShoe) {
  Points points = wall_in_base(SE3::Identity());
  const std::size_t of_wall = points.size();
  points.emplace_back(2000.0F, 0.0F, 0.0F);
  for (int i = 0; i < 4000; ++i)  // a tin beside it, 60 mm away
    points.emplace_back(140 + 15 * std::cos(0.1F * static_cast<float>(i)),
                        130 + 15 * std::sin(0.1F * static_cast<float>(i)), 0.01F * static_cast<float>(i));
  const auto sut = find_shoe(points);
  CHECK(sut.has_value());
  DOUBLES_EQUAL(90, sut->width_mm, 4);
  for (const std::uint32_t i : sut->index) CHECK(i < of_wall);
}

TEST(FindShoe, AColumnBesideTheShoeThatIsLargerIsNotPartOfIt) {
  const SE3 T_base_shoe = biteline::test::somewhere();
  const Points wall = wall_in_base(T_base_shoe);
  // With the column the whole is still as broad as a shoe may be.
  for (const double radius_mm : {20.0, 30.0}) {
    Points points = wall;
    for (double z = 0; z < 250; z += 0.7) {
      for (double angle = 0; angle < 6.28; angle += 0.03) {
        const Vec3 place{140 + radius_mm * std::cos(angle), 75 + radius_mm + radius_mm * std::sin(angle), z};
        points.push_back((T_base_shoe * place).cast<float>());
      }
    }
    const auto sut = find_shoe(points);
    CHECK(sut.has_value());
    DOUBLES_EQUAL(280, sut->length_mm, 4);
    DOUBLES_EQUAL(90, sut->width_mm, 4);
    for (const std::uint32_t i : sut->index) CHECK(i < wall.size());
  }
}

TEST(FindShoe, WhatIsNoShoeIsRefusedByItsOwnCode) {
  const Points few(12, Eigen::Vector3f::Zero());
  CHECK(find_shoe(few).error().code == Refused::TooFewPoints);

  std::mt19937 random{3};
  std::uniform_real_distribution<float> far{-400, 400};
  Points dust;
  for (int i = 0; i < 3000; ++i) dust.emplace_back(far(random), far(random), far(random));
  CHECK(find_shoe(dust).error().code == Refused::NothingConnected);

  Points shaft;
  for (int i = 0; i < 40000; ++i) {
    const float a = 0.05F * static_cast<float>(i);
    shaft.emplace_back(0.02F * static_cast<float>(i), 12 * std::cos(a), 12 * std::sin(a));
  }
  CHECK(find_shoe(shaft).error().code == Refused::NotShoeSized);
}

}  // namespace biteline::bite_line
