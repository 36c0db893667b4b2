// SPDX-License-Identifier: MIT
#include "hal/sim/live/fastest_way.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::sim {

namespace {

/// The rest is for what happens between samples.
constexpr double k_share = 0.92;
constexpr double k_none = 1e-12;

/// What one sample allows: x is the speed squared, u the acceleration along the way.
class Stage {
 public:
  Stage(const JointVector& slope, const JointVector& bend, const WayLimits& limits, double slower)
      : slope_(slope), bend_(bend), limits_(limits), share_(k_share / slower) {
    highest_x_ = limits.speed_mm_s * limits.speed_mm_s;
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double turn = std::max(k_none, std::abs(slope[i]));
      highest_x_ = std::min(highest_x_, std::pow(share_ * limits.joints.speed_rad_s[i] / turn, 2));
    }
  }

  struct Range {
    double low, high;
  };
  /// Of u at x; empty (low above high) where the bend alone is too much.
  [[nodiscard]] Range accelerations(double x) const {
    Range range{-limits_.acceleration_mm_s2, limits_.acceleration_mm_s2};
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double most = share_ / k_share * share_ * limits_.joints.acceleration_rad_s2[i],
                   bent = bend_[i] * x;
      if (std::abs(slope_[i]) < k_none) {
        if (std::abs(bent) > most) return {1, 0};
        continue;
      }
      const double a = (-most - bent) / slope_[i], b = (most - bent) / slope_[i];
      range = {std::max(range.low, std::min(a, b)), std::min(range.high, std::max(a, b))};
    }
    return range;
  }
  /// The highest x from which some acceleration leads to `next_x` or less.
  [[nodiscard]] double highest_towards(double next_x, double step_mm) const {
    const auto possible = [&](double x) {
      const Range range = accelerations(x);
      return std::max(range.low, -x / (2 * step_mm)) <= std::min(range.high, (next_x - x) / (2 * step_mm));
    };
    if (possible(highest_x_)) return highest_x_;
    double low = 0, high = highest_x_;  // what is possible is convex and holds rest
    for (int i = 0; i < 50; ++i) (possible(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    return low;
  }

 private:
  JointVector slope_, bend_;
  const WayLimits& limits_;
  double share_;
  double highest_x_;
};

/// The quickest law jumps from one limit to another; this takes the edges off.  Ends at rest stay so.
std::vector<double> smoothed(const std::vector<double>& speed_mm_s) {
  constexpr std::size_t k_side = 6;
  std::vector<double> smooth(speed_mm_s.size(), 0);
  for (std::size_t i = 1; i + 1 < speed_mm_s.size(); ++i) {
    const std::size_t side = std::min({k_side, i, speed_mm_s.size() - 1 - i});
    double sum = 0;
    for (std::size_t k = i - side; k <= i + side; ++k) sum += speed_mm_s[k] * speed_mm_s[k];
    smooth[i] = std::sqrt(sum / static_cast<double>(2 * side + 1));
  }
  return smooth;
}

}  // namespace

std::vector<double> fastest_way(const std::vector<JointVector>& q_rad, double step_mm,
                                const WayLimits& limits) {
  const std::size_t count = q_rad.size();
  std::vector<Stage> stages;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = std::clamp<std::size_t>(i, 1, count - 2);
    const JointVector &a = q_rad[at - 1], &b = q_rad[at], &c = q_rad[at + 1];
    stages.emplace_back((c - a) / (2 * step_mm), (c - 2 * b + a) / (step_mm * step_mm), limits,
                        limits.slower.empty() ? 1.0 : limits.slower[i]);
  }
  // From the end: how fast one may be and still stop.
  std::vector<double> highest_x(count, 0);
  for (std::size_t i = count - 1; i > 0; --i)
    highest_x[i - 1] = stages[i - 1].highest_towards(highest_x[i], step_mm);
  // From the begin: as fast as that.
  std::vector<double> speed_mm_s(count, 0);
  double x = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const double u = std::min(stages[i].accelerations(x).high, (highest_x[i + 1] - x) / (2 * step_mm));
    x = std::clamp(x + 2 * step_mm * u, 0.0, highest_x[i + 1]);
    speed_mm_s[i + 1] = std::sqrt(x);
  }
  return smoothed(speed_mm_s);
}

}  // namespace biteline::sim
