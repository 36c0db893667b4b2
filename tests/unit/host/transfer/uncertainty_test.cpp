// SPDX-License-Identifier: MIT
#include "host/transfer/uncertainty.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

namespace biteline::transfer {
namespace {

constexpr double k_u95_sigmas = 1.959964;

struct Height {
  double weight, mean_mm, sigma_mm;
};

/// Of a line on an upright wall, met by level rays: what is left open in height alone moves it.
double u95_mm(const std::vector<Height>& heights) {
  Belief belief;
  for (const Height& height : heights) {
    BeliefPart part{.weight = height.weight, .mean = Twist::Zero(), .covariance = {}};
    part.mean[2] = height.mean_mm;
    part.covariance.setZero();
    part.covariance(2, 2) = height.sigma_mm * height.sigma_mm;
    belief.push_back(part);
  }
  std::vector<PlacedPoint> placed;
  for (int i = 0; i < 12; ++i) {
    const double turn_rad = 2 * std::numbers::pi * i / 12;
    const Vec3 outward{std::cos(turn_rad), std::sin(turn_rad), 0};
    placed.push_back({.position = 50 * outward, .normal = outward});
  }
  tell_spread(belief, SE3::Identity(), {}, placed);
  for (const PlacedPoint& point : placed) DOUBLES_EQUAL(placed[0].sigma_mm, point.sigma_mm, 1e-6);
  return k_u95_sigmas * placed[0].sigma_mm;
}

double share_within(const std::vector<Height>& heights, double within_mm) {
  double share = 0;
  for (const Height& h : heights) {
    share += h.weight * 0.5 *
             (std::erf((within_mm - h.mean_mm) / h.sigma_mm / std::numbers::sqrt2) +
              std::erf((within_mm + h.mean_mm) / h.sigma_mm / std::numbers::sqrt2));
  }
  return share;
}

}  // namespace

TEST_GROUP(TransferUncertainty){};

TEST(TransferUncertainty, OfOneNormalDistributionItIsThatsOwn) {
  DOUBLES_EQUAL(k_u95_sigmas * 0.2, u95_mm({{1, 0, 0.2}}), 1e-6);
}

TEST(TransferUncertainty, ItHoldsNineteenOfTwentyHoweverTheBeliefLies) {
  // Far apart, one narrow and one wide, one that is hardly believed, one within the other.
  for (const std::vector<Height>& heights :
       {std::vector<Height>{{0.5, -0.8, 0.02}, {0.5, 0.8, 0.02}},
        std::vector<Height>{{0.9, 0, 0.01}, {0.1, 0, 1.0}},
        std::vector<Height>{{0.93, 0, 0.02}, {0.07, 1.5, 0.02}},
        std::vector<Height>{{0.951, 0, 0.02}, {0.049, 1.5, 0.02}},
        std::vector<Height>{{0.6, 0.1, 0.3}, {0.3, -0.2, 0.05}, {0.1, 0.4, 0.5}}}) {
    DOUBLES_EQUAL(0.95, share_within(heights, u95_mm(heights)), 1e-5);
  }
}

}  // namespace biteline::transfer
