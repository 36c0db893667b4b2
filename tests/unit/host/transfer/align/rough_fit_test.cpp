// SPDX-License-Identifier: MIT
#include "host/transfer/align/rough_fit.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <map>
#include <numbers>

#include "host/transfer/align/alignment.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_pair.hpp"

namespace biteline::transfer {
namespace {

constexpr double k_rad_per_deg = std::numbers::pi / 180;

const test::MadePair& pair_of(std::uint64_t seed) {
  static std::map<std::uint64_t, test::MadePair> pairs;
  const auto [at, is_new] = pairs.try_emplace(seed);
  if (is_new)
    at->second = test::made_pair({.seed = seed, .scan = {.profile_step_mm = 1.5, .column_step_mm = 0.2}});
  return at->second;
}

Sample sample_of(std::uint64_t seed) {
  return *prepare_sample(pair_of(seed).sample_cloud, pair_of(seed).sample_line);
}

cloud::PointCloud moved(const cloud::PointCloud& cloud, const SE3& T) {
  cloud::PointCloud out = cloud;
  for (Eigen::Vector3f& p : out.points) p = (T * p.cast<double>()).cast<float>();
  return out;
}

double fit_mm(const RoughShape& shape, const cloud::PointCloud& upper_cloud) {
  const Result<Upper> upper = prepare_upper(upper_cloud);
  SUCCEEDS(upper);
  return rough_fit(shape, RoughTarget{*upper}).off_mm;
}

}  // namespace

TEST_GROUP(RoughFit){};

TEST(RoughFit, LetsEveryUpperToItsOwnModelAndNoOther) {
  for (std::uint64_t model = 1; model <= 4; ++model) {
    const RoughShape shape = rough_shape_of(sample_of(model));
    for (std::uint64_t upper = 1; upper <= 4; ++upper) {
      const double mm = fit_mm(shape, pair_of(upper).upper_cloud);
      CHECK_EQUAL(model == upper, mm <= k_most_rough_mm);
    }
  }
}

TEST(RoughFit, FindsTheRightModelWhereverItLies) {
  const RoughShape shape = rough_shape_of(sample_of(1));
  for (int deg = 0; deg < 360; deg += 45) {
    const SE3 T{Eigen::Translation3d{200, -30, 12} * Eigen::AngleAxisd{deg * k_rad_per_deg, Vec3::UnitZ()} *
                Eigen::AngleAxisd{8 * k_rad_per_deg, Vec3{std::cos(deg), std::sin(deg), 0}}};
    CHECK(fit_mm(shape, moved(pair_of(1).upper_cloud, T)) <= k_most_rough_mm);
  }
}

TEST(RoughFit, LetsThroughWhatAlignTakesOfAPartialScan) {
  const Sample sample = sample_of(1);
  const RoughShape shape = rough_shape_of(sample);
  cloud::PointCloud part;
  const SE3 T_shoe_base = pair_of(1).T_base_upper.inverse();
  int taken = 0;
  for (const double behind_mm : {20.0, 40.0, 60.0, 80.0}) {
    part.points.clear();
    for (const Eigen::Vector3f& p : pair_of(1).upper_cloud.points) {
      if ((T_shoe_base * p.cast<double>()).x() > behind_mm) part.points.push_back(p);
    }
    const Result<Upper> upper = prepare_upper(part);
    SUCCEEDS(upper);
    if (!align(sample, *upper, {}).accepted()) continue;
    ++taken;
    CHECK(rough_fit(shape, RoughTarget{*upper}).off_mm <= k_most_rough_mm);
  }
  CHECK(taken > 0);
}

TEST(RoughFit, TellsTheOtherFoot) {
  const RoughShape shape = rough_shape_of(sample_of(1));
  CHECK(fit_mm(mirrored(shape), pair_of(1).upper_cloud) > k_most_rough_mm);
  CHECK(fit_mm(mirrored(mirrored(shape)), pair_of(1).upper_cloud) <= k_most_rough_mm);
}

TEST(RoughFit, NothingToCompareFitsNowhere) {
  CHECK(std::isinf(
      fit_mm(RoughShape{.coarse = {.pitch_mm = 8}, .few = {.pitch_mm = 2}}, pair_of(1).upper_cloud)));
}

}  // namespace biteline::transfer
