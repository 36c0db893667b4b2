// SPDX-License-Identifier: MIT
#include "host/intake/capture/known_piece.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/support/errors.hpp"

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
  void add_ball(double diameter_mm, double share, std::size_t count) {
    const double r = diameter_mm / 2;
    for (std::size_t i = 0; i < count; ++i) {
      const double z = 1 - share * any(0, 1), turn = any(0, 6.283185307), rho = std::sqrt(1 - z * z);
      const double at = r + noise(0.03);
      points.emplace_back(400 + at * rho * std::cos(turn), 20 + at * rho * std::sin(turn), 50 + at * z);
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

}  // namespace biteline::capture
