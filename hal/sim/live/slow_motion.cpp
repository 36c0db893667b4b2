// SPDX-License-Identifier: MIT
#include "hal/sim/live/slow_motion.hpp"

#include <algorithm>
#include <utility>

namespace biteline::sim {

namespace {

double slowest_ratio(Nanoseconds period) {
  return std::min(static_cast<double>(period.count()) / static_cast<double>(k_slowest_period.count()), 1.0);
}

}  // namespace

double affordable_ratio(Nanoseconds picture, Nanoseconds period) {
  const double in_a_period =
      static_cast<double>(period.count()) / static_cast<double>(std::max<std::int64_t>(picture.count(), 1));
  return std::clamp(0.5 * in_a_period, slowest_ratio(period), 1.0);
}

Nanoseconds mean_turn(int turns, const std::function<void(int turn)>& work) {
  work(0);
  const auto begin = std::chrono::steady_clock::now();
  for (int turn = 0; turn < turns; ++turn) work(turn);
  return (std::chrono::steady_clock::now() - begin) / turns;
}

TimeShare::TimeShare(double ratio, Nanoseconds period) : ratio_{ratio}, slowest_{slowest_ratio(period)} {}

void TimeShare::late_by(Nanoseconds late) {
  std::int64_t worst_ns = worst_late_ns_;
  while (late.count() > worst_ns && !worst_late_ns_.compare_exchange_weak(worst_ns, late.count())) {
  }
}

bool TimeShare::settle() {
  const bool late = worst_late_ns_.exchange(0) > k_most_late.count();
  if (!late || ratio_ <= slowest_) return false;
  ratio_ = std::max(0.5 * ratio_, slowest_);
  return true;
}

FlangeMotion slowed(FlangeMotion motion, double ratio) {
  motion.duration_s /= ratio;
  if (motion.q_rad_at)
    motion.q_rad_at = [at = std::move(motion.q_rad_at), ratio](double time_s) { return at(ratio * time_s); };
  if (motion.T_base_flange_at) {
    motion.T_base_flange_at = [at = std::move(motion.T_base_flange_at), ratio](double time_s) {
      return at(ratio * time_s);
    };
  }
  return motion;
}

}  // namespace biteline::sim
