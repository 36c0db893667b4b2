// SPDX-License-Identifier: MIT
#include "host/transfer/align/surfels.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <random>

namespace biteline::transfer {

constexpr float k_pitch_mm = 2;

TEST_GROUP(Surfels) {
  std::mt19937 random{3};
  std::uniform_real_distribution<float> unit{0, 1};

  /// Upright elliptic tube, evenly covered but for one half that is covered ten times as densely.
  std::vector<Eigen::Vector3f> tube(int points) {
    std::vector<Eigen::Vector3f> tube_points;
    for (int i = 0; i < points; ++i) {
      const float turn_rad = 2 * std::numbers::pi_v<float> * unit(random);
      const int copies = turn_rad < std::numbers::pi_v<float> ? 10 : 1;
      for (int k = 0; k < copies; ++k) {
        const float turned_rad = turn_rad + 0.01F * unit(random);
        tube_points.emplace_back(130 * std::cos(turned_rad), 45 * std::sin(turned_rad), 50 * unit(random));
      }
    }
    return tube_points;
  }
};

TEST(Surfels, AreEvenlyDenseWhereThePointsAreNot) {
  const Surfels sut = surfels_of(tube(40000), k_pitch_mm);
  std::size_t left = 0;
  for (const Eigen::Vector3f& p : sut.positions) left += p.y() > 0 ? 1 : 0;
  DOUBLES_EQUAL(0.5, static_cast<double>(left) / static_cast<double>(sut.size()), 0.05);
}

TEST(Surfels, NormalsAreThoseOfTheSurfaceAndLookOutward) {
  const Surfels sut = surfels_of(tube(40000), k_pitch_mm);
  // A neighbourhood of 3 pitches that is cut off by the tube's end or unevenly filled tilts a plane by some
  // degrees.
  constexpr float k_tol_rad = 0.2F;
  for (std::size_t i = 0; i < sut.size(); ++i) {
    const Eigen::Vector3f& p = sut.positions[i];
    const Eigen::Vector3f truth = Eigen::Vector3f(p.x() / (130 * 130), p.y() / (45 * 45), 0).normalized();
    CHECK(sut.normals[i].dot(truth) > std::cos(k_tol_rad));
  }
}

TEST(Surfels, StrayPointsMakeNone) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 500; ++i)
    points.push_back(300 * Eigen::Vector3f(unit(random), unit(random), unit(random)));
  CHECK(surfels_of(points, k_pitch_mm).size() == 0);
}

TEST(Surfels, CoarseningKeepsSurfaceAndNormals) {
  const Surfels fine = surfels_of(tube(40000), k_pitch_mm);
  const Surfels sut = coarsened(fine, 8);
  CHECK(sut.size() * 8 < fine.size());
  for (std::size_t i = 0; i < sut.size(); ++i) {
    const Eigen::Vector3f& p = sut.positions[i];
    // The mean of a curved patch lies inside by at most pitch²/(8 R); the tube's ends have R = 45²/130 = 16
    // mm.
    DOUBLES_EQUAL(1.0, std::hypot(p.x() / 130, p.y() / 45), 0.03);
    DOUBLES_EQUAL(1.0, sut.normals[i].norm(), 1e-5);
  }
}

}  // namespace biteline::transfer
