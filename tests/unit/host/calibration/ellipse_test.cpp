// SPDX-License-Identifier: MIT
#include "host/calibration/rings/ellipse.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/calibration/rings/homography.hpp"

namespace biteline::calibration {

TEST_GROUP(Ellipse) {
  std::mt19937_64 random{11};
  Ellipse sut{.centre = Vec2(812.3, 301.7), .major_semi = 55, .minor_semi = 38, .angle_rad = 0.4};

  std::vector<Vec2> points(int count, double noise) {
    std::normal_distribution<double> normal(0, 1);
    std::vector<Vec2> result;
    for (int i = 0; i < count; ++i) {
      const double phase_rad = 2 * std::numbers::pi * i / count;
      result.push_back(sut.at(phase_rad) + noise * normal(random) * sut.normal_at(phase_rad));
    }
    return result;
  }

  /// A plane seen at 40 degrees: perspective of 20 % over the circle.
  Mat3 strong_perspective() {
    Mat3 H;
    H << 900, 40, 400, -30, 700, 300, 0.15, 0.6, 1;
    return H;
  }
};

TEST(Ellipse, FitRecoversExactPoints) {
  const auto fitted = fit_ellipse(points(40, 0));
  CHECK(fitted.has_value());
  DOUBLES_EQUAL(0.0, (fitted->centre - sut.centre).norm(), 1e-8);
  DOUBLES_EQUAL(sut.major_semi, fitted->major_semi, 1e-8);
  DOUBLES_EQUAL(sut.minor_semi, fitted->minor_semi, 1e-8);
  DOUBLES_EQUAL(0.0, std::sin(fitted->angle_rad - sut.angle_rad), 1e-9);
}

TEST(Ellipse, NoiseOfTheCentreIsWhatThePointsAllow) {
  // 200 points of 0.2 px along the normals: sigma * sqrt(2 / n) = 0.02 per coordinate; four of these.
  double sum = 0;
  for (int i = 0; i < 50; ++i) sum += (fit_ellipse(points(200, 0.2))->centre - sut.centre).squaredNorm();
  CHECK(std::sqrt(sum / 50) < 1.5 * 0.2 * std::sqrt(2 * 2.0 / 200));
}

TEST(Ellipse, PointsOnALineAreNoEllipse) {
  std::vector<Vec2> line;
  for (int i = 0; i < 30; ++i) line.emplace_back(i, 2.0 * i + 1e-3 * (i % 3));
  CHECK_FALSE(fit_ellipse(line).has_value());
  CHECK_FALSE(fit_ellipse(std::vector<Vec2>(5, Vec2(1, 2))).has_value());
}

TEST(Ellipse, RobustFitShedsACoveredPart) {
  std::vector<Vec2> all = points(100, 0.05);
  for (int i = 0; i < 20; ++i)
    all[static_cast<std::size_t>(i)] -= (2.0 + 0.3 * i) * sut.normal_at(2 * std::numbers::pi * i / 100);
  const auto fitted = fit_ellipse_robustly(all, 0.1);
  CHECK(fitted.has_value());
  DOUBLES_EQUAL(0.0, (fitted->ellipse.centre - sut.centre).norm(), 0.05);
  CHECK(fitted->coverage_ratio < 0.9);
  for (int i = 0; i < 20; ++i) CHECK_FALSE(fitted->kept[static_cast<std::size_t>(i)]);
}

TEST(Ellipse, ConicRoundTrip) {
  const auto back = Ellipse::from_conic(-3.7 * sut.conic());
  CHECK(back.has_value());
  DOUBLES_EQUAL(0.0, (back->centre - sut.centre).norm(), 1e-8);
  DOUBLES_EQUAL(sut.minor_semi, back->minor_semi, 1e-8);
}

TEST(Ellipse, ProjectedCircleHoldsTheProjectedPoints) {
  const Mat3 H = strong_perspective();
  const auto ellipse = project_circle(H, Vec2(0.1, -0.05), 0.2);
  CHECK(ellipse.has_value());
  for (int i = 0; i < 36; ++i) {
    const double phase_rad = i * std::numbers::pi / 18;
    const Vec2 on_circle = Vec2(0.1, -0.05) + 0.2 * Vec2(std::cos(phase_rad), std::sin(phase_rad));
    DOUBLES_EQUAL(0.0, ellipse->distance(apply_homography(H, on_circle)), 1e-9);
  }
}

TEST(Ellipse, PairGivesTheTrueCentreWhereTheEllipsesDoNot) {
  const Mat3 H = strong_perspective();
  const Vec2 centre(0.1, -0.05);
  const auto outer = project_circle(H, centre, 0.2), inner = project_circle(H, centre, 0.1);
  const Vec2 truth = apply_homography(H, centre);
  const auto pair = concentric_centre(*outer, *inner);
  CHECK(pair.has_value());
  CHECK((outer->centre - truth).norm() > 5);  // the bias this corrects
  DOUBLES_EQUAL(0.0, (pair->centre - truth).norm(), 1e-6);
  DOUBLES_EQUAL(0.5, pair->diameter_ratio, 1e-9);
}

}  // namespace biteline::calibration
