// SPDX-License-Identifier: MIT
#include "host/intake/capture/known_piece.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <random>
#include <vector>

#include "host/intake/capture/refused.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/refusals.hpp"

namespace biteline::capture {

TEST_GROUP(KnownPiece) {
  std::mt19937_64 random{11};
  std::vector<Vec3> points;

  double noise(double sigma_mm) {
    return std::normal_distribution<double>{0, sigma_mm}(random);
  }
  double any(double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(random);
  }

  /// The cap of a ball that a head from above sees, `share` of its half.
  void add_ball(double diameter_mm, double share, std::size_t count, double x_mm = 400) {
    const double r = diameter_mm / 2;
    for (std::size_t i = 0; i < count; ++i) {
      const double z = 1 - share * any(0, 1), turn = any(0, 6.283185307), rho = std::sqrt(1 - z * z);
      const double at = r + noise(0.03);
      points.emplace_back(x_mm + at * rho * std::cos(turn), 20 + at * rho * std::sin(turn), 50 + at * z);
    }
  }
  void add_plane(double z_mm, double from_x_mm, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      points.emplace_back(any(from_x_mm, from_x_mm + 40), any(-30, 30), z_mm + noise(0.02));
  }
};

TEST(KnownPiece, ABallAmongOtherThingsIsMeasuredWithinItsSigma) {
  add_ball(30.0, 0.8, 4000);
  add_plane(35, 380, 8000);
  for (int i = 0; i < 500; ++i) points.emplace_back(any(380, 420), any(0, 40), any(30, 80));
  const auto ball = measure_ball(points, 30.1);
  SUCCEEDS(ball);
  // The scatter of 0.03 mm over 4000 points, and strays that happen to lie near.
  DOUBLES_EQUAL(30.0, ball->size_mm, 0.015);
  CHECK(ball->sigma_mm > 0 && ball->sigma_mm < 0.01);
  DOUBLES_EQUAL(0.03, ball->rms_mm, 0.01);
}

TEST(KnownPiece, AHeadThatIsWrongByHalfAPercentShows) {
  add_ball(30.15, 0.8, 4000);
  const auto ball = measure_ball(points, 30.0);
  SUCCEEDS(ball);
  DOUBLES_EQUAL(0.15, ball->size_mm - 30.0, 0.01);
}

TEST(KnownPiece, WithoutABallThereIsNone) {
  add_plane(10, 0, 5000);
  CHECK_FALSE(measure_ball(points, 30).has_value());
  CHECK_FALSE(measure_ball({}, 30).has_value());
  points.clear();
  add_ball(30, 0.01, 3000);  // a cap of eight degrees
  FAILS_NAMING(Errc::Refused, "ball of 30", measure_ball(points, 30));
}

TEST(KnownPiece, TheFormErrorIsTheRangeWithoutTheFarthest) {
  add_ball(30.0, 0.8, 20000);
  const auto ball = fit_ball(points, 30, 0.3);
  SUCCEEDS(ball);
  DOUBLES_EQUAL(30.0, ball->size.size_mm, 0.01);
  CHECK((ball->centre - Vec3(400, 20, 50)).norm() < 0.01);
  // Of a normal scatter of 0.03 mm 99.7 % lie within 2.97 of it; an edge of so many points is known to 2 %.
  DOUBLES_EQUAL(2 * 2.968 * 0.03, ball->form_mm, 0.05 * 2 * 2.968 * 0.03);
}

TEST(KnownPiece, ABarIsTheDistanceOfItsBalls) {
  add_ball(30.0, 0.8, 4000);
  add_ball(30.0, 0.8, 4000, 520);
  add_plane(35, 380, 8000);
  const auto bar = measure_bar(points, {.diameter_mm = 30, .distance_mm = 120});
  SUCCEEDS(bar);
  CHECK(bar->sigma_mm > 0 && bar->sigma_mm < 0.005);
  DOUBLES_EQUAL(120, bar->distance_mm, 0.015);
  FAILS_NAMING(Errc::Refused, "no bar of 200", measure_bar(points, {.diameter_mm = 30, .distance_mm = 200}));
  points.resize(4000);
  FAILS_NAMING(Errc::Refused, "only one ball", measure_bar(points, {.diameter_mm = 30, .distance_mm = 120}));
}

TEST(KnownPiece, APlateThatIsSeenBentIsNotFlat) {
  // A bow of 0.2 mm over 60 mm, and a scatter of 0.01 mm.
  for (std::size_t i = 0; i < 20000; ++i) {
    const double x = any(-30, 30), y = any(-10, 10);
    points.emplace_back(x, y, 7 + 0.2 * (x / 30) * (x / 30) + noise(0.01));
  }
  points.emplace_back(0, 0, 90);  // something else
  const auto flat = measure_flat(points, 0.6);
  SUCCEEDS(flat);
  // The bow's range is 0.2 mm; the scatter adds less than three of its deviations at either end.
  CHECK(flat->flatness_mm > 0.2 && flat->flatness_mm < 0.2 + 6 * 0.01);
  // It reaches over the corners' way at most.
  CHECK(flat->across_mm > 59 && flat->across_mm < 64);
  LONGS_EQUAL(20000, flat->points);
  points.resize(100);
  FAILS_NAMING(Errc::Refused, "no plane", measure_flat(points, 0.6));
}

TEST(KnownPiece, AStepIsTheDistanceOfItsFaces) {
  add_plane(0, 0, 6000);
  add_plane(12.5, 42, 3000);
  const auto step = measure_step(points, 12.4);
  SUCCEEDS(step);
  // Beside each other: the common direction's error over 42 mm is 0.0005 mm or so.
  DOUBLES_EQUAL(12.5, step->size_mm, 0.01);
  CHECK(step->sigma_mm > 0 && step->sigma_mm < 0.005);
}

TEST(KnownPiece, AStepOfAnotherHeightIsNone) {
  add_plane(0, 0, 6000);
  add_plane(12.5, 42, 3000);
  FAILS_NAMING(Errc::Refused, "no step of about 20", measure_step(points, 20));
  CHECK_FALSE(measure_step({}, 20).has_value());
}

TEST(KnownPiece, CodesAreInTheirTable) {
  test::check_refusal_table(AcceptRefused::BeyondLimit);
}

}  // namespace biteline::capture
