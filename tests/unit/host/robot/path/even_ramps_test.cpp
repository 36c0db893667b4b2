// SPDX-License-Identifier: MIT
#include "host/robot/path/even_ramps.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace biteline::path {
namespace {

constexpr double k_window_s = 0.125;

/// Ramps of 500 mm/s^2 at both ends, 100 mm/s between, 400 mm with so many places.
struct Ramps {
  std::vector<double> arc_mm, speed_mm_s;

  explicit Ramps(int count) {
    for (int i = 0; i < count; ++i) {
      const double step_mm = 400.0 / (count - 1), from_end_mm = step_mm * std::min(i, count - 1 - i);
      arc_mm.push_back(step_mm * i);
      speed_mm_s.push_back(std::min(100.0, std::sqrt(2 * 500 * from_end_mm)));
    }
  }
};

}  // namespace

TEST_GROUP(EvenRamps){};

TEST(EvenRamps, TakeTheirWindowLongerAndEndAtRest) {
  const Ramps ramps{201};
  const TimeLaw law = averaged(ramps.arc_mm, ramps.speed_mm_s, k_window_s);
  // 380 mm at 100 mm/s, two ramps of 0.2 s.
  DOUBLES_EQUAL(4.2 + k_window_s, law.time_s.back(), 2e-3);
  DOUBLES_EQUAL(0, law.speed_mm_s.front(), 0);
  DOUBLES_EQUAL(0, law.speed_mm_s.back(), 0);
  DOUBLES_EQUAL(100, law.speed_mm_s[100], 1e-6);
  CHECK(std::ranges::is_sorted(law.time_s));
  // No speed above what was there, no acceleration above it either.
  for (std::size_t i = 1; i < law.time_s.size(); ++i) {
    CHECK(law.speed_mm_s[i] <= 100 + 1e-6);
    const double change = std::abs(std::pow(law.speed_mm_s[i], 2) - std::pow(law.speed_mm_s[i - 1], 2));
    CHECK(change / 4 <= 500 * 1.02);
  }
}

TEST(EvenRamps, LeaveWhatSwingsInTheirWindowAtRest) {
  const Ramps ramps{4001};
  // What is left of a swing at the plain ramps' end, and at the averaged ones'.
  const auto left_mm = [&](const std::vector<double>& time_s, const std::vector<double>& speed_mm_s) {
    const double w = 2 * std::numbers::pi / k_window_s;
    double x = 0, y = 0;
    for (std::size_t i = 1; i < time_s.size() / 2; ++i) {
      constexpr int k_parts = 20;
      const double step_s = (time_s[i] - time_s[i - 1]) / k_parts;
      for (int k = 0; k < k_parts; ++k) {
        const double v = speed_mm_s[i - 1] + (speed_mm_s[i] - speed_mm_s[i - 1]) * (k + 0.5) / k_parts;
        y -= step_s * w * w * x;
        x += step_s * (y - v);
      }
    }
    // At even speed the link swings about its drive.
    return std::hypot(x, (y - speed_mm_s[time_s.size() / 2 - 1]) / w);
  };
  std::vector<double> plain_s{0};
  for (std::size_t i = 1; i < ramps.arc_mm.size(); ++i)
    plain_s.push_back(plain_s.back() + 0.2 / (ramps.speed_mm_s[i] + ramps.speed_mm_s[i - 1]));
  const TimeLaw law = averaged(ramps.arc_mm, ramps.speed_mm_s, k_window_s);
  const double before_mm = left_mm(plain_s, ramps.speed_mm_s), after_mm = left_mm(law.time_s, law.speed_mm_s);
  CHECK(before_mm > 0.1);
  CHECK(after_mm < 0.2 * before_mm);
}

TEST(EvenRamps, SlowsDownAsFarAheadAsAMeanReaches) {
  std::vector<double> arc_mm, speed_mm_s;
  for (int i = 0; i <= 100; ++i) {
    arc_mm.push_back(2.0 * i);
    speed_mm_s.push_back(i == 0 || i == 100 ? 0 : i == 50 ? 30 : 100);
  }
  const std::vector<double> lowered = lowered_for_mean(arc_mm, speed_mm_s, k_window_s);
  // Half the window at 100 mm/s is 6.25 mm: three places to either side.
  for (std::size_t i = 0; i <= 100; ++i) {
    const bool near = i >= 47 && i <= 53;
    DOUBLES_EQUAL(near ? 30 : speed_mm_s[i], lowered[i], 0);
  }
  const TimeLaw law = averaged(arc_mm, lowered, k_window_s);
  CHECK(law.speed_mm_s[50] <= 45);
}

}  // namespace biteline::path
