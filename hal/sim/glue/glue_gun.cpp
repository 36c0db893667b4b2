// SPDX-License-Identifier: MIT
#include "hal/sim/glue/glue_gun.hpp"

#include <cmath>

namespace biteline::sim {

double GlueGun::step(double step_s, bool gun, double analog_ratio) {
  if (gun != told_) {
    told_ = gun;
    // A needle that is told to close before it has opened stays closed, and the other way round.
    if (!edges_.empty() && edges_.back().open != gun) {
      edges_.pop_back();
    } else {
      edges_.push_back({.at_s = time_s_ + (gun ? facts_.opens_s : facts_.closes_s), .open = gun});
    }
  }
  const double end_s = time_s_ + step_s;
  double open_s = 0, from_s = time_s_;
  while (!edges_.empty() && edges_.front().at_s <= end_s) {
    if (open_) open_s += edges_.front().at_s - from_s;
    from_s = edges_.front().at_s;
    open_ = edges_.front().open;
    edges_.pop_front();
  }
  if (open_) open_s += end_s - from_s;
  time_s_ = end_s;
  // Exact for an output that stands over the step.
  const double keeps = facts_.pump_lag_s > 0 ? std::exp(-step_s / facts_.pump_lag_s) : 0;
  flow_ratio_ = facts_.metered ? analog_ratio + keeps * (flow_ratio_ - analog_ratio) : 1;
  const double out = flow_ratio_ * open_s / step_s;
  given_s_ += out * step_s;
  return given_s_ > facts_.good_for_s ? facts_.then_ratio * out : out;
}

}  // namespace biteline::sim
