// SPDX-License-Identifier: MIT
#pragma once
/// \file How old a state is when it is read.

#include <algorithm>
#include <optional>

#include "host/robot/link/robot_link.hpp"

namespace biteline::robot {

/// The controller stamps by its own clock, so an age is known only against the youngest state of the same
/// link: its way over a quiet network and through a host that had nothing else to do. That least value rises
/// slowly, by twice what two quartz clocks drift apart (100 ppm), so that a day's drift is no age.
class StateAge {
 public:
  /// Seconds, at least 0.  Pre: states as they are received.
  [[nodiscard]] double take(const RobotState& state) {
    const double apart_s =
        1e-9 *
        static_cast<double>((state.received.time_since_epoch() - state.sampled.time_since_epoch()).count());
    if (last_)
      least_s_ += k_drift * std::max(0.0, 1e-9 * static_cast<double>((state.received - *last_).count()));
    least_s_ = last_ ? std::min(least_s_, apart_s) : apart_s;
    last_ = state.received;
    return apart_s - least_s_;
  }

 private:
  static constexpr double k_drift = 2e-4;
  std::optional<HostClock::time_point> last_;
  double least_s_{0};
};

}  // namespace biteline::robot
