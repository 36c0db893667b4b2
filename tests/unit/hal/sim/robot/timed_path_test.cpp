// SPDX-License-Identifier: MIT
#include "hal/sim/robot/timed_path.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "tests/support/transforms.hpp"

namespace biteline::sim {

namespace {

SE3 at(double x, double y) {
  return geometry::make_se3(Eigen::Quaterniond::Identity(), {x, y, 0});
}

}  // namespace

TEST_GROUP(TimedPath){};

TEST(TimedPath, OneMoveTakesTheTimeOfItsTrapezoid) {
  const TimedPath sut(at(0, 0), {{.T_base_tcp = at(300, 0), .speed_mm_s = 100, .acceleration_mm_s2 = 500}});
  // way / speed + speed / acceleration, to one sample of 0.5 mm at each end
  DOUBLES_EQUAL(3.2, sut.duration_s(), 0.01);
  DOUBLES_EQUAL(150, sut.T_base_tcp_at(1.6).translation().x(), 1.0);
  TRANSFORMS_EQUAL(at(300, 0), sut.T_base_tcp_at(9), 1e-9, 1e-9);
}

TEST(TimedPath, StopsAtACornerWithoutBlendAndRunsThroughOneWith) {
  for (const double blend_mm : {0.0, 10.0}) {
    const TimedPath sut(
        at(0, 0),
        {{.T_base_tcp = at(100, 0), .speed_mm_s = 100, .acceleration_mm_s2 = 1000, .blend_mm = blend_mm},
         {.T_base_tcp = at(100, 100), .speed_mm_s = 100, .acceleration_mm_s2 = 1000}});
    double slowest_mm_s = 1e9, nearest_mm = 1e9;
    constexpr double k_step_s = 0.002;
    for (double t = 0.2; t < sut.duration_s() - 0.2; t += k_step_s) {
      const Vec3 p = sut.T_base_tcp_at(t).translation();
      slowest_mm_s =
          std::min(slowest_mm_s, (sut.T_base_tcp_at(t + k_step_s).translation() - p).norm() / k_step_s);
      nearest_mm = std::min(nearest_mm, (p - Vec3(100, 0, 0)).norm());
    }
    if (blend_mm == 0) {
      CHECK(slowest_mm_s < 10);
      CHECK(nearest_mm < 0.1);
    } else {
      CHECK(slowest_mm_s > 60);
      // A parabola through (90, 0), (100, 0), (100, 10) passes the corner at half the control point's
      // distance.
      DOUBLES_EQUAL(10 * std::sqrt(2) / 4, nearest_mm, 0.2);
    }
  }
}

TEST(TimedPath, AFineCurveKeepsItsSpeedAndStaysWithinTheBlendsSag) {
  std::vector<StraightMove> moves;
  constexpr double k_radius_mm = 35;
  for (int i = 1; i <= 100; ++i) {
    const double angle = 0.03 * i;
    SE3 T = at(k_radius_mm * std::sin(angle), k_radius_mm * (1 - std::cos(angle)));
    T.linear() = geometry::exp_so3(Vec3(0, 0, angle));
    moves.push_back({.T_base_tcp = T, .speed_mm_s = 30, .acceleration_mm_s2 = 500, .blend_mm = 0.4});
  }
  const TimedPath sut(at(0, 0), moves);
  constexpr double k_step_s = 0.01;
  for (double t = 0.3; t < sut.duration_s() - 0.3; t += k_step_s) {
    const SE3 T = sut.T_base_tcp_at(t);
    const Vec3 from_centre = T.translation() - Vec3(0, k_radius_mm, 0);
    // Chords of 1.05 mm: sagitta 1.05^2 / (8 * 35) = 0.004 mm.
    DOUBLES_EQUAL(k_radius_mm, from_centre.norm(), 0.006);
    DOUBLES_EQUAL(30, (sut.T_base_tcp_at(t + k_step_s).translation() - T.translation()).norm() / k_step_s,
                  0.5);
  }
}

TEST(TimedPath, ATurnOnTheSpotTakesTime) {
  SE3 turned = at(0, 0);
  turned.linear() = geometry::exp_so3(Vec3(0, 0, 1));
  const TimedPath sut(at(0, 0), {{.T_base_tcp = turned, .speed_mm_s = 20, .acceleration_mm_s2 = 1000}});
  CHECK(sut.duration_s() > 1);
}

}  // namespace biteline::sim
