// SPDX-License-Identifier: MIT
#include "common/geometry/pose_track.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/transforms.hpp"

namespace biteline::geometry {
namespace {

SensorClock::time_point at_s(double time_s) {
  return SensorClock::time_point{Nanoseconds{static_cast<std::int64_t>(std::llround(1e9 * time_s))}};
}

/// Round a shoe's toe: 3 m/s at the flange, 10 rad/s, and both change.
SE3 swinging(double time_s) {
  const double turn_rad = 1.2 * std::sin(8.0 * time_s) + 0.4 * time_s;
  const Vec3 place_mm{280 * std::cos(turn_rad) - 60 * time_s, 280 * std::sin(turn_rad),
                      152 + 5 * std::sin(3 * time_s)};
  return make_se3(
      Eigen::Quaterniond{Eigen::AngleAxisd{turn_rad, Vec3::UnitZ()} * Eigen::AngleAxisd{0.7, Vec3::UnitX()}},
      place_mm);
}

}  // namespace

TEST_GROUP(PoseTrack) {
  std::mt19937_64 random{11};
  std::normal_distribution<double> normal;

  std::vector<PoseSample> record(double period_s, int count, double noise_mm, double noise_rad) {
    std::vector<PoseSample> samples;
    for (int i = 0; i < count; ++i) {
      Twist xi;
      for (int k = 0; k < 6; ++k) xi[k] = normal(random) * (k < 3 ? noise_mm : noise_rad);
      samples.push_back({.stamp = at_s(i * period_s), .T_base_flange = swinging(i * period_s) * exp_se3(xi)});
    }
    return samples;
  }
};

TEST(PoseTrack, AnEncodersCountIsLinearBetweenTheTwoNeighbours) {
  std::vector<PoseSample> samples = record(0.002, 5, 0, 0);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i].encoder_ticks = -7 + static_cast<std::int64_t>(i * i) * 10;
  const auto count_at = [&](double time_s) {
    PoseEstimate sut;
    CHECK(rt_pose_at(samples, at_s(time_s), {}, sut));
    return sut.encoder_ticks;
  };
  CHECK(count_at(0.002) == 3);    // at a sample: its own
  CHECK(count_at(0.0029) == 17);  // 3 + 0.45 * 30 = 16.5, to the nearest
  CHECK(count_at(0.0000) == -7);
  CHECK(count_at(0.0001) == -6);  // -6.5, away from zero as a way of 0.5
  CHECK(count_at(0.008) == 153);
  CHECK(!count_at(0.0081));  // nothing behind: none is made up
  CHECK(!count_at(-0.0001));
  samples[2].encoder_ticks.reset();
  CHECK(!count_at(0.003));
  CHECK(count_at(0.001) == -2);
  samples[1].encoder_ticks = std::numeric_limits<std::int64_t>::min();
  samples[0].encoder_ticks = std::numeric_limits<std::int64_t>::max();
  CHECK(!count_at(0.001));  // no machine's
}

TEST(PoseTrack, NoCountAcrossAHole) {
  const std::vector<PoseSample> samples{{.stamp = at_s(1), .encoder_ticks = 100},
                                        {.stamp = at_s(2.5), .encoder_ticks = 200}};
  PoseEstimate sut;
  CHECK(rt_pose_at(samples, at_s(1.2), {}, sut));
  CHECK(sut.stale && !sut.encoder_ticks);
}

TEST(PoseTrack, ExactMotionIsNotRoundedAndHasNoLag) {
  const auto samples = record(0.002, 500, 0, 0);
  PoseEstimate sut;
  for (double time_s = 0.1; time_s < 0.9; time_s += 0.0137) {
    CHECK(rt_pose_at(samples, at_s(time_s), {}, sut));
    // A twentieth of a scanner's error: 0.2 um, and its angle at 300 mm.
    TRANSFORMS_EQUAL(swinging(time_s), sut.T_base_flange, 2e-4, 7e-7);
    CHECK(!sut.extrapolated);
    CHECK(!sut.stale);
  }
}

TEST(PoseTrack, IndependentNoiseShrinksAndItsRestIsToldHonestly) {
  constexpr double k_noise_mm = 0.010, k_noise_rad = 5e-5;
  const auto samples = record(0.002, 3000, k_noise_mm, k_noise_rad);
  double sum = 0, sum_normalised = 0;
  int count = 0;
  PoseEstimate sut;
  for (double time_s = 0.1; time_s < 5.9; time_s += 0.0313) {
    CHECK(rt_pose_at(samples, at_s(time_s), {}, sut));
    const Vec3 error = swinging(time_s).linear().transpose() *
                       (sut.T_base_flange.translation() - swinging(time_s).translation());
    sum += error.squaredNorm() / 3;
    sum_normalised += error.squaredNorm() / (3 * sut.sigma_mm * sut.sigma_mm);
    ++count;
  }
  const double rms_mm = std::sqrt(sum / count);
  // 3 / sqrt(8 * 6) of the noise for the narrowest window; wider ones do better.
  CHECK(rms_mm < 0.45 * k_noise_mm);
  // 186 instants of three coordinates: 6 % of scatter in the variance; the choice of window adds some.
  DOUBLES_EQUAL(1.0, sum_normalised / count, 0.35);
}

TEST(PoseTrack, WithoutSmoothingItIsTheGeodesicBetweenNeighbours) {
  const auto samples = record(0.008, 10, 0, 0);
  PoseEstimate sut;
  CHECK(rt_pose_at(samples, at_s(0.026), {.samples_each_side = 1}, sut));
  TRANSFORMS_EQUAL(interpolate(samples[3].T_base_flange, samples[4].T_base_flange, 0.25), sut.T_base_flange,
                   1e-3, 1e-6);
  LONGS_EQUAL(2, sut.sample_count);
}

TEST(PoseTrack, VelocityIsTheBodyTwist) {
  const auto samples = record(0.002, 500, 0, 0);
  PoseEstimate sut;
  CHECK(rt_pose_at(samples, at_s(0.5), {}, sut));
  constexpr double k_step_s = 1e-4;
  const Twist expected =
      log_se3(swinging(0.5 - k_step_s).inverse() * swinging(0.5 + k_step_s)) / (2 * k_step_s);
  DOUBLES_EQUAL(0, (sut.velocity_per_s - expected).norm() / expected.norm(), 0.02);
}

TEST(PoseTrack, SaysHowOldAndOnWhichSide) {
  const auto samples = record(0.002, 100, 0, 0);  // last at 0.198 s
  PoseEstimate sut;
  CHECK(rt_pose_at(samples, at_s(0.199), {}, sut));
  LONGS_EQUAL(1'000'000, sut.age.count());
  CHECK(sut.extrapolated);
  CHECK(!sut.stale);
  // Extrapolated by half a period: still good to a hundredth of a millimetre.
  TRANSFORMS_EQUAL(swinging(0.199), sut.T_base_flange, 0.01, 1e-4);
  CHECK(rt_pose_at(samples, at_s(0.3), {}, sut));
  CHECK(sut.stale);
  CHECK(!rt_pose_at({}, at_s(0.3), {}, sut));
}

// A bus that goes off and comes back, on a way that the fit follows exactly: what is not called stale is as
// good as four samples' noise (4.5 deviations, 52 000 estimates).
TEST(PoseTrack, WhatIsNotStaleBesideAGapIsGood) {
  constexpr double k_noise_mm = 0.001, k_noise_rad = 1e-5;
  const auto on_circle = [](double time_s) {
    const double turn_rad = 2.5 * time_s;
    return make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{turn_rad, Vec3::UnitZ()}},
                    100 * Vec3{std::cos(turn_rad), std::sin(turn_rad), 0});
  };
  int usable = 0;
  for (int round = 0; round < 1000; ++round) {
    std::vector<PoseSample> samples;
    for (int i = 0; i < 150; ++i) {
      Twist xi;
      for (int k = 0; k < 6; ++k) xi[k] = normal(random) * (k < 3 ? k_noise_mm : k_noise_rad);
      const double time_s = 0.004 * i;
      if (i < 50 || i >= 110)
        samples.push_back({.stamp = at_s(time_s), .T_base_flange = on_circle(time_s) * exp_se3(xi)});
    }
    for (const double begin_s : {0.188, 0.428}) {
      for (double time_s = begin_s; time_s < begin_s + 0.026; time_s += 0.001) {
        PoseEstimate sut;
        CHECK(rt_pose_at(samples, at_s(time_s), {}, sut));
        if (sut.stale) continue;
        ++usable;
        const Vec3 error = sut.T_base_flange.translation() - on_circle(time_s).translation();
        CHECK_COMPARE(error.norm(), <, 4.5 * 4 * k_noise_mm);
      }
    }
  }
  // Up to a period beyond the last one, and from the second one after the gap on.
  CHECK(usable > 15'000);
  PoseEstimate alone;
  const PoseSample first{.stamp = at_s(1), .T_base_flange = on_circle(1)};
  CHECK(rt_pose_at({&first, 1}, at_s(1.002), {}, alone));
  CHECK(alone.stale);
}

TEST(PoseTrack, GapIsInterpolatedAndAged) {
  auto samples = record(0.002, 200, 0, 0);
  samples.erase(samples.begin() + 90, samples.begin() + 115);  // 52 ms without a pose
  PoseEstimate sut;
  CHECK(rt_pose_at(samples, at_s(0.204), {}, sut));
  CHECK(sut.stale);
  CHECK(!sut.extrapolated);
  TRANSFORMS_EQUAL(swinging(0.204), sut.T_base_flange, 0.1, 1e-3);
}

TEST(PoseTrack, HoleOfYearsIsStaleAndItsPoseOneOfTheSamples) {
  // Three years after five good poses; the exposure stands a millisecond behind the last of them.
  auto samples = record(0.002, 5, 0, 0);
  samples.push_back(
      {.stamp = samples.back().stamp + std::chrono::hours{3 * 8766}, .T_base_flange = swinging(1)});
  PoseEstimate sut;
  CHECK(rt_pose_at(samples, at_s(0.009), {}, sut));
  CHECK(sut.stale);
  TRANSFORMS_EQUAL(samples[4].T_base_flange, sut.T_base_flange, 1e-9, 1e-9);
  const auto half_way = samples[4].stamp + std::chrono::hours{13149};
  CHECK(rt_pose_at(samples, half_way, {}, sut));
  CHECK(sut.stale);
  CHECK(sut.T_base_flange.matrix().allFinite() && sut.sigma_mm == 0);
}

TEST(PoseTrack, IsEquivariantOnTheLeft) {
  // Asymmetric: would fail if base and flange were swapped.
  const SE3 T_world_base =
      make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{0.9, Vec3{1, 2, -1}.normalized()}}, {300, -20, 70});
  auto samples = record(0.002, 300, 0.01, 5e-5);
  PoseEstimate in_base, in_world;
  CHECK(rt_pose_at(samples, at_s(0.3), {}, in_base));
  for (PoseSample& sample : samples) sample.T_base_flange = T_world_base * sample.T_base_flange;
  CHECK(rt_pose_at(samples, at_s(0.3), {}, in_world));
  TRANSFORMS_EQUAL(T_world_base * in_base.T_base_flange, in_world.T_base_flange, 1e-7, 1e-9);
}

}  // namespace biteline::geometry
