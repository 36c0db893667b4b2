// SPDX-License-Identifier: MIT
#include "hal/timing/clock_map.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::hal {
namespace {

// Below this many minima a slope is mostly their noise; the mean offset alone is better.
constexpr std::size_t k_minima_for_slope = 8;

}  // namespace

ClockMapCore::Verdict ClockMapCore::add(Arrival arrival) {
  ++counts_.samples;
  const Point sample{.stamp_ns = arrival.stamp_ns, .offset_ns = arrival.received_ns - arrival.stamp_ns};
  if (!started_) {
    restart(sample);
    return Verdict::Used;
  }
  const std::int64_t expected_ns = minima_count_ > 0 ? offset_at(sample.stamp_ns) : best_.offset_ns;
  const std::int64_t excess_ns = sample.offset_ns - expected_ns;
  const std::int64_t threshold_ns = config_.step_threshold.count();
  // Nothing arrives before it was sent: the other clock was set forward.
  const bool forward = excess_ns < -threshold_ns;
  late_in_a_row_ = excess_ns > threshold_ns ? late_in_a_row_ + 1 : 0;
  if (forward || late_in_a_row_ >= config_.late_run) {
    ++counts_.steps;
    restart(sample);
    return Verdict::Stepped;
  }
  if (late_in_a_row_ > 0) {
    ++counts_.late;
    return Verdict::Late;
  }
  if (arrival.received_ns >= bucket_end_ns_) {
    close_bucket();
    best_ = sample;
    bucket_end_ns_ = arrival.received_ns + config_.bucket.count();
  } else if (sample.offset_ns < best_.offset_ns) {
    best_ = sample;
  }
  return Verdict::Used;
}

void ClockMapCore::restart(Point first) {
  started_ = true;
  minima_count_ = 0;
  oldest_ = 0;
  late_in_a_row_ = 0;
  slope_ = 0;
  best_ = first;
  bucket_end_ns_ = first.stamp_ns + first.offset_ns + config_.bucket.count();
}

void ClockMapCore::close_bucket() {
  minima_[(oldest_ + minima_count_) % k_buckets] = best_;
  if (minima_count_ < k_buckets) {
    ++minima_count_;
  } else {
    oldest_ = (oldest_ + 1) % k_buckets;
  }
  fit();
}

void ClockMapCore::fit() {
  const Point& last = minima_[(oldest_ + minima_count_ - 1) % k_buckets];
  origin_ns_ = last.stamp_ns;
  const auto count = static_cast<double>(minima_count_);
  double mean_t = 0;
  double mean_o = 0;
  for (std::size_t i = 0; i < minima_count_; ++i) {
    mean_t += static_cast<double>(minima_[i].stamp_ns - last.stamp_ns) / count;
    mean_o += static_cast<double>(minima_[i].offset_ns - last.offset_ns) / count;
  }
  slope_ = 0;
  if (minima_count_ >= k_minima_for_slope) {
    double covariance = 0;
    double variance = 0;
    for (std::size_t i = 0; i < minima_count_; ++i) {
      const double t = static_cast<double>(minima_[i].stamp_ns - last.stamp_ns) - mean_t;
      covariance += t * (static_cast<double>(minima_[i].offset_ns - last.offset_ns) - mean_o);
      variance += t * t;
    }
    const double limit = config_.drift_max_ppm * 1e-6;
    if (variance > 0) slope_ = std::clamp(covariance / variance, -limit, limit);
  }
  base_ns_ = last.offset_ns + std::llround(mean_o - slope_ * mean_t);
  double square_sum = 0;
  for (std::size_t i = 0; i < minima_count_; ++i) {
    const auto residual = static_cast<double>(minima_[i].offset_ns - offset_at(minima_[i].stamp_ns));
    square_sum += residual * residual;
  }
  // Twice the scatter of one minimum: the line itself is surer, but its bias is of the minima's size.
  scatter_ns_ = std::llround(2 * std::sqrt(square_sum / count));
}

std::int64_t ClockMapCore::offset_at(std::int64_t stamp_ns) const {
  return base_ns_ + std::llround(slope_ * static_cast<double>(stamp_ns - origin_ns_));
}

std::optional<std::int64_t> ClockMapCore::to_sensor_ns(std::int64_t stamp_ns) const {
  if (minima_count_ == 0) return std::nullopt;
  return stamp_ns + offset_at(stamp_ns) - config_.delay_min.count();
}

ClockMapHealth ClockMapCore::health() const {
  ClockMapHealth health = counts_;
  health.ready = minima_count_ > 0;
  if (health.ready) {
    health.offset = Nanoseconds{offset_at(best_.stamp_ns)} - config_.delay_min;
    health.uncertainty = Nanoseconds{scatter_ns_} + config_.delay_uncertainty;
    health.drift_ppm = slope_ * 1e6;
  }
  return health;
}

}  // namespace biteline::hal
