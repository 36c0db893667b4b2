// SPDX-License-Identifier: MIT
#include "host/calibration/drift/self_starting.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::drift {
namespace {

/// A normal deviate as rare as Student's t (Wallace, "Bounds on normal approximations to Student's and the
/// chi-square distributions", 1959): within 0.02 for more than five degrees of freedom.
double normal_of(double t, double freedom) {
  const double size =
      (8 * freedom + 1) / (8 * freedom + 3) * std::sqrt(freedom * std::log1p(t * t / freedom));
  return std::copysign(size, t);
}

}  // namespace

double SelfStarting::sigma() const {
  if (state_.count < 2) return least_sigma_;
  return std::max(least_sigma_, std::sqrt(state_.squares / (state_.count - 1)));
}

void SelfStarting::take(double value) {
  if (knows()) {
    const double t = (value - state_.mean) / (sigma() * std::sqrt(1 + 1.0 / state_.count));
    const double score = std::clamp(normal_of(t, state_.count - 1), -k_most_score, k_most_score);
    state_.high = std::max(0.0, state_.high + score - k_slack);
    state_.low = std::max(0.0, state_.low - score - k_slack);
  }
  state_.on_trial.push_back(value);
  if (state_.on_trial.size() <= k_on_trial) return;
  const double proven = state_.on_trial.front();
  state_.on_trial.pop_front();
  ++state_.count;
  const double off = proven - state_.mean;
  state_.mean += off / state_.count;
  state_.squares += off * (proven - state_.mean);
}

}  // namespace biteline::drift
