// SPDX-License-Identifier: MIT
#include "common/geometry/pose_track.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace biteline::geometry {
namespace {

constexpr int k_max_window = 2 * PoseSmoothing::k_max_each_side;

/// Samples used for one instant, as twists about a reference pose near it.
struct Window {
  SE3 T_base_reference{SE3::Identity()};
  std::array<Twist, k_max_window> xi;      ///< log(T_base_reference^-1 T_base_flange)
  std::array<double, k_max_window> time_s; ///< from the instant
  int count{0};
};

double seconds(Nanoseconds duration) { return 1e-9 * static_cast<double>(duration.count()); }

/// Value and derivative at time 0 of the least-squares polynomial through (time, xi).
struct PolynomialAtZero {
  Twist value{Twist::Zero()};
  Twist rate_per_s{Twist::Zero()};
};

/// Normal equations of fixed size: their closed-form inverse neither allocates nor loses digits that matter, since times
/// are scaled to [-1, 1] (condition below 1000 for a cubic).
template <int Terms>
PolynomialAtZero fit_at_zero(const Window& window) {
  using Powers = Eigen::Matrix<double, Terms, 1>;
  const auto count = static_cast<std::size_t>(window.count);
  double scale_s = 1e-9;
  for (std::size_t i = 0; i < count; ++i) scale_s = std::max(scale_s, std::fabs(window.time_s[i]));
  Eigen::Matrix<double, Terms, Terms> normal = Eigen::Matrix<double, Terms, Terms>::Zero();
  Eigen::Matrix<double, 6, Terms> right = Eigen::Matrix<double, 6, Terms>::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    Powers power = Powers::Ones();
    for (int k = 1; k < Terms; ++k) power[k] = power[k - 1] * (window.time_s[i] / scale_s);
    normal += power * power.transpose();
    right += window.xi[i] * power.transpose();
  }
  const Eigen::Matrix<double, 6, Terms> coefficients = right * normal.inverse();
  PolynomialAtZero out;
  out.value = coefficients.col(0);
  if constexpr (Terms > 1) out.rate_per_s = coefficients.col(1) / scale_s;
  return out;
}

PolynomialAtZero fit_at_zero(const Window& window) {
  // A cubic needs its four samples and some more to smooth at all.
  if (window.count >= 6) return fit_at_zero<4>(window);
  if (window.count >= 2) return fit_at_zero<2>(window);
  return {.value = window.xi[0], .rate_per_s = Twist::Zero()};
}

}  // namespace

bool rt_pose_at(std::span<const PoseSample> samples, SensorClock::time_point instant, const PoseSmoothing& smoothing,
                PoseEstimate& out) noexcept {
  if (samples.empty()) return false;
  const auto after = std::lower_bound(samples.begin(), samples.end(), instant,
                                      [](const PoseSample& s, SensorClock::time_point t) { return s.stamp < t; });
  const auto split = static_cast<std::ptrdiff_t>(after - samples.begin());
  const auto size = static_cast<std::ptrdiff_t>(samples.size());

  out = {};
  out.extrapolated = split == size || (split == 0 && samples.front().stamp != instant);
  const std::ptrdiff_t nearest_before = std::max<std::ptrdiff_t>(split - 1, 0), nearest_after = std::min(split, size - 1);
  const Nanoseconds before_age = instant - samples[static_cast<std::size_t>(nearest_before)].stamp;
  const Nanoseconds after_age = samples[static_cast<std::size_t>(nearest_after)].stamp - instant;
  out.age = std::min(std::chrono::abs(before_age), std::chrono::abs(after_age));
  out.stale = out.age > smoothing.stale_after;

  // At least the two neighbours, which make plain interpolation; more of them within reach.  As many on either side:
  // a lopsided window lags.
  const int each_side = std::clamp(smoothing.samples_each_side, 1, PoseSmoothing::k_max_each_side);
  std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, split - each_side), last = std::min(size, split + each_side);
  while (first < split - 1 && instant - samples[static_cast<std::size_t>(first)].stamp > smoothing.reach) ++first;
  while (last > split + 1 && samples[static_cast<std::size_t>(last - 1)].stamp - instant > smoothing.reach) --last;
  if (first == split) last = std::min(size, std::max(last, split + 2));
  if (last == split) first = std::max<std::ptrdiff_t>(0, std::min(first, split - 2));

  Window window;
  window.T_base_reference = samples[static_cast<std::size_t>(nearest_before)].T_base_flange;
  const SE3 T_reference_base = window.T_base_reference.inverse();
  for (std::ptrdiff_t i = first; i < last; ++i) {
    const PoseSample& sample = samples[static_cast<std::size_t>(i)];
    window.xi[static_cast<std::size_t>(window.count)] = log_se3(T_reference_base * sample.T_base_flange);
    window.time_s[static_cast<std::size_t>(window.count)] = seconds(sample.stamp - instant);
    ++window.count;
  }
  const PolynomialAtZero fit = fit_at_zero(window);
  out.T_base_flange = window.T_base_reference * exp_se3(fit.value);
  // The reference is a neighbouring sample: the twist's rate is the body velocity to first order in the angle between.
  out.velocity_per_s = fit.rate_per_s;
  out.sample_count = window.count;
  return true;
}

}  // namespace biteline::geometry
