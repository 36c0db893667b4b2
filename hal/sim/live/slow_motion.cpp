// SPDX-License-Identifier: MIT
#include "hal/sim/live/slow_motion.hpp"

#include <algorithm>
#include <utility>

namespace biteline::sim {

double affordable_ratio(Nanoseconds picture, Nanoseconds period) {
  const auto share = [&](Nanoseconds time) {
    return static_cast<double>(period.count()) / static_cast<double>(std::max<std::int64_t>(time.count(), 1));
  };
  const double slowest = std::min(share(k_slowest_period), 1.0);
  return std::clamp(0.5 * share(picture), slowest, 1.0);
}

Nanoseconds mean_turn(int turns, const std::function<void(int turn)>& work) {
  work(0);
  const auto begin = std::chrono::steady_clock::now();
  for (int turn = 0; turn < turns; ++turn) work(turn);
  return (std::chrono::steady_clock::now() - begin) / turns;
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
