// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "host/bite_line/published/level_set.hpp"

namespace biteline::published {
namespace {

struct Sample {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> outward;
};

Sample ball(float radius_mm, std::size_t count, float noise_mm) {
  std::mt19937 random{11};
  std::normal_distribution<float> normal;
  Sample sample;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f n = Eigen::Vector3f{normal(random), normal(random), normal(random)}.normalized();
    sample.points.emplace_back((radius_mm + noise_mm * normal(random)) * n);
    sample.outward.push_back(n);
  }
  return sample;
}

/// A cylinder seen from inside, so that it is a valley: radius 1.5 mm, the floor's middle at x = z = 0, along
/// y.
Sample valley(std::size_t count, float noise_mm) {
  constexpr float k_radius_mm = 1.5F;
  std::mt19937 random{12};
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> angle{-1.3F, 1.3F};
  std::uniform_real_distribution<float> along{0.0F, 20.0F};
  Sample sample;
  for (std::size_t i = 0; i < count; ++i) {
    const float a = angle(random);
    const Eigen::Vector3f inwards{-std::sin(a), 0, std::cos(a)};
    const float r = k_radius_mm + noise_mm * normal(random);
    sample.points.emplace_back(r * std::sin(a), along(random), k_radius_mm - r * std::cos(a));
    sample.outward.push_back(inwards);
  }
  return sample;
}

double median(std::vector<float> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return static_cast<double>(values[values.size() / 2]);
}

constexpr std::array k_solvers{Solver::WeightedPca, Solver::LeastSquares};

}  // namespace

TEST_GROUP(LevelSet){};

TEST(LevelSet, BallIsConvexWithItsRadius) {
  const Sample sample = ball(5.0F, 6000, 0.0F);
  for (const Solver solver : k_solvers) {
    const Curvature sut = estimate_curvature(sample.points, sample.outward, {.solver = solver});
    // A quadric holds a ball exactly; the levels at +-c are not quite those of one quadric.
    DOUBLES_EQUAL(0.2, median(sut.mean_per_mm), 0.001);
    DOUBLES_EQUAL(0.04, median(sut.gaussian_per_mm2), 0.0005);
    for (std::size_t i = 0; i < sample.points.size(); ++i) {
      CHECK(sut.trusted[i] != 0);
      // Neighbours lie unevenly round a point of a ball: the plane tilts by some degrees at worst.
      CHECK_COMPARE(sut.normal[i].dot(sample.outward[i]), >, 0.995F);
    }
  }
}

TEST(LevelSet, NoisyValleyIsConcaveWithItsRadius) {
  const Sample sample = valley(9000, 0.03F);
  for (const Solver solver : k_solvers) {
    const Curvature sut = estimate_curvature(sample.points, sample.outward, {.solver = solver});
    std::vector<float> floor;
    for (std::size_t i = 0; i < sample.points.size(); ++i) {
      const Eigen::Vector3f& p = sample.points[i];
      if (std::abs(p.x()) < 0.2F && p.y() > 2 && p.y() < 18)
        floor.push_back(principal(sut.mean_per_mm[i], sut.gaussian_per_mm2[i]).smaller_per_mm);
    }
    DOUBLES_EQUAL(-1.0 / 1.5, median(floor), 0.03);
  }
}

TEST(LevelSet, WithoutLevelsAFlatWallIsFullOfFalseFeatures) {
  // What the published comparison shows: plain SVD finds many false points.
  std::mt19937 random{3};
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> place{0.0F, 40.0F};
  Sample wall;
  for (int i = 0; i < 8000; ++i) {
    wall.points.emplace_back(place(random), place(random), 0.03F * normal(random));
    wall.outward.emplace_back(0, 0, 1);
  }
  const auto features = [&](Solver solver) {
    const Curvature c = estimate_curvature(wall.points, wall.outward, {.solver = solver});
    return std::count_if(c.mean_per_mm.begin(), c.mean_per_mm.end(),
                         [](float mean) { return mean < -0.06F; });
  };
  CHECK_COMPARE(5 * features(Solver::WeightedPca), <, features(Solver::PlainSvd));
}

TEST(LevelSet, LevelsWithinTheNoiseReadTooLittleCurvatureByTotalLeastSquares) {
  // Radius 1.5 mm, noise 0.03 mm, R = 5 mm; c = 0.05 mm gives 0.03 instead of 0.2.
  const Sample sample = ball(5.0F, 6000, 0.03F);
  const Curvature narrow = estimate_curvature(sample.points, sample.outward,
                                              {.solver = Solver::WeightedPca, .offset_ratio = 0.05F / 1.5F});
  const Curvature sut = estimate_curvature(sample.points, sample.outward, {.solver = Solver::WeightedPca});
  CHECK(median(narrow.mean_per_mm) < 0.17);
  DOUBLES_EQUAL(0.2, median(sut.mean_per_mm), 0.005);
}

TEST(LevelSet, MovingTheCloudChangesNoCurvature) {
  // Few enough points that every neighbourhood is used whole.
  Sample sample = valley(800, 0.0F);
  const Curvature before = estimate_curvature(sample.points, sample.outward, {});
  const Eigen::Quaternionf R{Eigen::AngleAxisf(0.7F, Eigen::Vector3f{0.3F, -0.8F, 0.5F}.normalized())};
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    sample.points[i] = R * sample.points[i] + Eigen::Vector3f{40, -25, 60};
    sample.outward[i] = R * sample.outward[i];
  }
  const Curvature after = estimate_curvature(sample.points, sample.outward, {});
  // Points at the rim of a neighbourhood come and go with the last bit: compare the typical point.
  std::vector<float> change;
  for (std::size_t i = 0; i < sample.points.size(); ++i)
    change.push_back(std::abs(after.mean_per_mm[i] - before.mean_per_mm[i]));
  CHECK(median(change) < 1e-3);
}

TEST(LevelSet, TwiceTheSizeIsHalfTheCurvature) {
  const Sample small = ball(5.0F, 3000, 0.0F);
  Sample large = small;
  for (Eigen::Vector3f& p : large.points) p *= 2;
  const Curvature a = estimate_curvature(small.points, small.outward, {.radius_mm = 1.5F});
  const Curvature b = estimate_curvature(large.points, large.outward, {.radius_mm = 3.0F});
  DOUBLES_EQUAL(median(a.mean_per_mm), 2 * median(b.mean_per_mm), 1e-4);
  DOUBLES_EQUAL(median(a.gaussian_per_mm2), 4 * median(b.gaussian_per_mm2), 1e-4);
}

TEST(LevelSet, NeighbourhoodsByCountAgreeWithThoseByRadius) {
  const Sample sample = ball(5.0F, 1500, 0.0F);
  const Curvature sut = estimate_curvature(sample.points, sample.outward, {.neighbours = 20});
  DOUBLES_EQUAL(0.2, median(sut.mean_per_mm), 0.001);
}

TEST(LevelSet, NormalsWithoutHintsAllPointOutwards) {
  // A torus: its inner side faces the cloud's middle, so "away from the middle" would be wrong there.
  std::mt19937 random{5};
  std::uniform_real_distribution<float> turn{0.0F, 6.2831853F};
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> outward;
  for (int i = 0; i < 12000; ++i) {
    const float a = turn(random);
    const float b = turn(random);
    outward.emplace_back(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
    points.emplace_back(Eigen::Vector3f{12 * std::cos(a), 12 * std::sin(a), 0} + 3 * outward.back());
  }
  const Curvature sut = estimate_curvature(points, {}, {.radius_mm = 1.0F});
  float worst = 1;
  for (std::size_t i = 0; i < points.size(); ++i) worst = std::min(worst, sut.normal[i].dot(outward[i]));
  // A normal tilts where neighbours are few; none is turned round.
  CHECK_COMPARE(worst, >, 0.6F);
}

TEST(LevelSet, TooFewNeighboursAreNotTrusted) {
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {50, 50, 50}};
  const Curvature sut = estimate_curvature(points, {}, {});
  for (std::size_t i = 0; i < points.size(); ++i) {
    LONGS_EQUAL(0, sut.trusted[i]);
    DOUBLES_EQUAL(0.0, sut.mean_per_mm[i], 0.0);
  }
}

}  // namespace biteline::published
