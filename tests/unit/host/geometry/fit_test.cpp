// SPDX-License-Identifier: MIT
#include "host/geometry/fit.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <random>
#include <vector>

#include "host/geometry/bridge.hpp"

namespace biteline::geometry {

TEST_GROUP(Fit){};

TEST(Fit, APlaneIsFoundInItsNoise) {
  const Vec3 normal = Vec3{0.2, -0.5, 0.8}.normalized();
  const Vec3 along = normal.unitOrthogonal();
  const Vec3 across = normal.cross(along);
  std::mt19937 random{6};
  std::normal_distribution<double> noise{0, 0.05};
  std::uniform_real_distribution<double> place{-10, 10};
  std::vector<Vec3> points;
  for (int i = 0; i < 4000; ++i)
    points.push_back(Vec3{5, 6, 7} + place(random) * along + 0.3 * place(random) * across +
                     noise(random) * normal);
  const auto sut = fit_plane(points);
  CHECK(sut.has_value());
  CHECK_COMPARE(std::abs(sut->normal.dot(normal)), >, std::cos(0.002));
  DOUBLES_EQUAL(0.05, std::sqrt(sut->spread_mm2[0]), 0.003);
  DOUBLES_EQUAL(3 / std::sqrt(3.0), std::sqrt(sut->spread_mm2[1]), 0.1);
  CHECK_FALSE(fit_plane(std::span<const Vec3>{points.data(), 2}).has_value());
}

TEST(Fit, ALineHasItsSlopeAndAHeapHasNone) {
  LineSums sut;
  for (int i = 0; i < 5; ++i) sut.add(i, 3 - 0.5 * i);
  DOUBLES_EQUAL(-0.5, sut.slope().value_or(99), 1e-12);
  LineSums heap;
  for (int i = 0; i < 5; ++i) heap.add(2, i);
  CHECK_FALSE(heap.slope().has_value());
}

TEST(Fit, TheDirectionAtACircularEndIsThatOfItsTangent) {
  // Two levers back on a circle of 60 mm: the chord beside the end lags by half a lever, the next by one and
  // a half.
  const auto at = [](double s_mm) {
    return Vec3{60 * std::sin(s_mm / 60), 60 * (1 - std::cos(s_mm / 60)), 0};
  };
  const CurveEnd sut{.end = at(0), .near = at(-k_end_lever_mm), .far = at(-2 * k_end_lever_mm)};
  const Vec3 direction = sut.direction().normalized();
  DOUBLES_EQUAL(0, std::atan2(direction.y(), direction.x()), 0.002);
}

}  // namespace biteline::geometry
