// SPDX-License-Identifier: MIT
#include "common/geometry/pose_track.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace biteline::geometry {
namespace {

constexpr int k_max_window = 2 * PoseSmoothing::k_max_each_side;

/// Samples each side of the narrowest smoothing window: with 500 Hz 24 ms, over which a cubic follows an arm
/// at its jerk limit.
constexpr int k_narrow_each_side = 6;
/// Neighbours farther apart tell nothing of the way between, however near one of them is; and times so
/// unequal leave the fit no digits.
constexpr Nanoseconds k_widest_hole = std::chrono::seconds{1};
/// 99 % point of chi-square with the six degrees of freedom of a pose.
constexpr double k_agreement = 16.8;
/// An estimate that scatters more than this many times as much as one sample is no measurement.  Between
/// samples the factor is at most 1; six samples extrapolated by one period have 3.6, by four periods 31.
constexpr double k_most_amplified = 4;
/// Below these, differences are rounding and not motion.
constexpr double k_rounding_mm = 1e-7, k_rounding_rad = 1e-10;

double seconds(Nanoseconds duration) {
  return 1e-9 * static_cast<double>(duration.count());
}

bool is_count(const std::optional<std::int64_t>& ticks) {
  return ticks && *ticks >= -k_most_ticks && *ticks <= k_most_ticks;
}

/// Pre: `instant` is between the two, or at the later one.
std::optional<std::int64_t> count_between(const PoseSample& before, const PoseSample& after,
                                          SensorClock::time_point instant) {
  if (after.stamp == instant) return after.encoder_ticks;
  if (!is_count(before.encoder_ticks) || !is_count(after.encoder_ticks)) return std::nullopt;
  const std::int64_t way_ticks = *after.encoder_ticks - *before.encoder_ticks;
  const double share = seconds(instant - before.stamp) / seconds(after.stamp - before.stamp);
  return *before.encoder_ticks + std::llround(share * static_cast<double>(way_ticks));
}

/// Samples around one instant, as twists about a reference pose near it.
struct Window {
  SE3 T_base_reference{SE3::Identity()};
  std::array<Twist, k_max_window> xi;       ///< log(T_base_reference^-1 T_base_flange)
  std::array<double, k_max_window> time_s;  ///< from the instant
  int count{0};
  int split{0};  ///< samples before the instant
};

/// Least-squares polynomial through part of a window, at time 0.
struct Fit {
  Twist value{Twist::Zero()};
  Twist rate_per_s{Twist::Zero()};
  double variance_ratio{1};                        ///< of the value to a single sample
  double sample_sigma_mm{0}, sample_sigma_rad{0};  ///< scatter about the fit; 0: no degree of freedom left
  int count{0};
};

/// Samples [first, last) by a polynomial of Terms - 1 degrees.  Normal equations of fixed size: their
/// closed-form inverse neither allocates nor loses digits that matter, since times are scaled to [-1, 1]
/// (condition below 1000 for a cubic).
template <int Terms>
Fit fit_at_zero(const Window& window, int first, int last) {
  using Powers = Eigen::Matrix<double, Terms, 1>;
  double scale_s = 1e-9;
  for (int i = first; i < last; ++i)
    scale_s = std::max(scale_s, std::fabs(window.time_s[static_cast<std::size_t>(i)]));
  const auto powers = [&](int i) {
    Powers power = Powers::Ones();
    for (int k = 1; k < Terms; ++k)
      power[k] = power[k - 1] * (window.time_s[static_cast<std::size_t>(i)] / scale_s);
    return power;
  };
  Eigen::Matrix<double, Terms, Terms> normal = Eigen::Matrix<double, Terms, Terms>::Zero();
  Eigen::Matrix<double, 6, Terms> right = Eigen::Matrix<double, 6, Terms>::Zero();
  for (int i = first; i < last; ++i) {
    const Powers power = powers(i);
    normal += power * power.transpose();
    right += window.xi[static_cast<std::size_t>(i)] * power.transpose();
  }
  const Eigen::Matrix<double, Terms, Terms> inverse = normal.inverse();
  const Eigen::Matrix<double, 6, Terms> coefficients = right * inverse;
  Fit fit;
  fit.count = last - first;
  fit.value = coefficients.col(0);
  if constexpr (Terms > 1) fit.rate_per_s = coefficients.col(1) / scale_s;
  fit.variance_ratio = inverse(0, 0);
  if (fit.count > Terms) {
    double sum_mm2 = 0, sum_rad2 = 0;
    for (int i = first; i < last; ++i) {
      const Twist residual = window.xi[static_cast<std::size_t>(i)] - coefficients * powers(i);
      sum_mm2 += residual.head<3>().squaredNorm();
      sum_rad2 += residual.tail<3>().squaredNorm();
    }
    const double freedom = 3.0 * (fit.count - Terms);
    fit.sample_sigma_mm = std::sqrt(sum_mm2 / freedom);
    fit.sample_sigma_rad = std::sqrt(sum_rad2 / freedom);
  }
  return fit;
}

/// True when the wider fit's value differs from the narrower one's by no more than their scatter explains. Of
/// nested least-squares fits the variances subtract.
bool agree(const Fit& narrow, const Fit& wide) {
  const double ratio = std::max(0.0, narrow.variance_ratio - wide.variance_ratio);
  const Twist difference = wide.value - narrow.value;
  const double variance_mm2 =
      ratio * narrow.sample_sigma_mm * narrow.sample_sigma_mm + k_rounding_mm * k_rounding_mm;
  const double variance_rad2 =
      ratio * narrow.sample_sigma_rad * narrow.sample_sigma_rad + k_rounding_rad * k_rounding_rad;
  return difference.head<3>().squaredNorm() / variance_mm2 +
             difference.tail<3>().squaredNorm() / variance_rad2 <
         k_agreement;
}

Fit fit_widest(const Window& window) {
  // A cubic needs its four samples and some more to smooth at all.
  constexpr int k_least_for_cubic = 6;
  if (window.count < 2) return {.value = window.xi[0], .count = 1};
  if (window.count < k_least_for_cubic) return fit_at_zero<2>(window, 0, window.count);

  const auto around = [&](int each_side) {
    // As many on either side: a lopsided window lags.  At the record's end there is no choice.
    int first = std::max(0, window.split - each_side),
        last = std::min(window.count, window.split + each_side);
    if (last - first < k_least_for_cubic) {
      first = std::max(0, std::min(first, last - k_least_for_cubic));
      last = std::min(window.count, first + k_least_for_cubic);
    }
    return fit_at_zero<4>(window, first, last);
  };
  Fit best = around(k_narrow_each_side);
  for (int each_side = 2 * k_narrow_each_side; best.count < window.count; each_side *= 2) {
    const Fit wider = around(each_side);
    if (wider.count == best.count || !agree(best, wider)) break;
    best = wider;
  }
  return best;
}

}  // namespace

bool rt_pose_at(std::span<const PoseSample> samples, SensorClock::time_point instant,
                const PoseSmoothing& smoothing, PoseEstimate& out) noexcept {
  if (samples.empty()) return false;
  const auto after =
      std::lower_bound(samples.begin(), samples.end(), instant,
                       [](const PoseSample& s, SensorClock::time_point t) { return s.stamp < t; });
  const auto split = static_cast<std::ptrdiff_t>(after - samples.begin());
  const auto size = static_cast<std::ptrdiff_t>(samples.size());

  out = {};
  out.extrapolated = split == size || (split == 0 && samples.front().stamp != instant);
  const std::ptrdiff_t nearest_before = std::max<std::ptrdiff_t>(split - 1, 0),
                       nearest_after = std::min(split, size - 1);
  const Nanoseconds before_age = instant - samples[static_cast<std::size_t>(nearest_before)].stamp;
  const Nanoseconds after_age = samples[static_cast<std::size_t>(nearest_after)].stamp - instant;
  out.age = std::min(std::chrono::abs(before_age), std::chrono::abs(after_age));
  const Nanoseconds hole = samples[static_cast<std::size_t>(nearest_after)].stamp -
                           samples[static_cast<std::size_t>(nearest_before)].stamp;
  out.stale = out.age > smoothing.stale_after || hole > k_widest_hole;
  if (!out.extrapolated && hole <= k_widest_hole)
    out.encoder_ticks = count_between(samples[static_cast<std::size_t>(nearest_before)],
                                      samples[static_cast<std::size_t>(nearest_after)], instant);
  if (hole > k_widest_hole) {
    out.T_base_flange =
        samples[static_cast<std::size_t>(before_age < after_age ? nearest_before : nearest_after)]
            .T_base_flange;
    out.sample_count = 1;
    return true;
  }

  // At least the two neighbours, which make plain interpolation; more of them within reach.  As many on
  // either side: a lopsided window lags.
  const int each_side = std::clamp(smoothing.samples_each_side, 1, PoseSmoothing::k_max_each_side);
  std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, split - each_side),
                 last = std::min(size, split + each_side);
  while (first < split - 1 && instant - samples[static_cast<std::size_t>(first)].stamp > smoothing.reach)
    ++first;
  while (last > split + 1 && samples[static_cast<std::size_t>(last - 1)].stamp - instant > smoothing.reach)
    --last;
  if (first == split) last = std::min(size, std::max(last, split + 2));
  if (last == split) first = std::max<std::ptrdiff_t>(0, std::min(first, split - 2));

  Window window;
  window.T_base_reference = samples[static_cast<std::size_t>(nearest_before)].T_base_flange;
  window.split = static_cast<int>(split - first);
  const SE3 T_reference_base = window.T_base_reference.inverse();
  for (std::ptrdiff_t i = first; i < last; ++i) {
    const PoseSample& sample = samples[static_cast<std::size_t>(i)];
    window.xi[static_cast<std::size_t>(window.count)] = log_se3(T_reference_base * sample.T_base_flange);
    window.time_s[static_cast<std::size_t>(window.count)] = seconds(sample.stamp - instant);
    ++window.count;
  }
  const Fit fit = fit_widest(window);
  out.T_base_flange = window.T_base_reference * exp_se3(fit.value);
  // The reference is a neighbouring sample: the twist's rate is the body velocity to first order in the angle
  // between.
  out.velocity_per_s = fit.rate_per_s;
  out.sigma_mm = fit.sample_sigma_mm * std::sqrt(fit.variance_ratio);
  out.sigma_rad = fit.sample_sigma_rad * std::sqrt(fit.variance_ratio);
  out.sample_count = fit.count;
  const bool amplified = !(fit.variance_ratio <= k_most_amplified * k_most_amplified);
  const bool held = fit.count < 2 && out.age.count() != 0;  // one sample tells nothing of its motion
  out.stale = out.stale || amplified || held;
  return true;
}

}  // namespace biteline::geometry
