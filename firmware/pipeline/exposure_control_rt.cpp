// SPDX-License-Identifier: MIT
#include "firmware/pipeline/exposure_control.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "common/core/contracts.hpp"

namespace biteline::pipeline {
namespace {

/// What a saturated share above the limit multiplies the exposure by.
constexpr float k_saturated_step_ratio = 0.7F;

}  // namespace

ExposureControl::Decision ExposureControl::rt_update(const profile::ProfileBuffer& profile,
                                                     int column_count) noexcept BITELINE_RT {
  BITELINE_EXPECTS(column_count > 0);
  // Amplitudes are grey levels: a histogram gives the median without sorting.
  std::array<int, 512> histogram{};
  int valid = 0, saturated = 0;
  for (const profile::ProfilePoint& point : profile.view()) {
    if (point.flags & profile::k_point_not_surface) continue;
    ++valid;
    if (point.flags & profile::k_point_saturated) ++saturated;
    ++histogram[static_cast<std::size_t>(std::clamp(point.amplitude, 0.0F, 511.0F))];
  }
  Decision decision{.exposure = exposure_,
                    .changed = false,
                    .valid_ratio = static_cast<float>(valid) / static_cast<float>(column_count)};
  if (valid > 0) {
    decision.saturated_ratio = static_cast<float>(saturated) / static_cast<float>(valid);
    std::size_t level = 0;
    for (int seen = histogram[0]; 2 * seen < valid; seen += histogram[++level]) {
    }
    decision.amplitude = static_cast<float>(level);
  }
  if (++profiles_since_step_ < config_.profiles_between_steps) return decision;

  float step_ratio = config_.largest_step_ratio;
  if (decision.valid_ratio >= config_.valid_least_ratio) {
    step_ratio = decision.saturated_ratio > config_.saturated_limit_ratio
                     ? k_saturated_step_ratio
                     : config_.target_amplitude / std::max(decision.amplitude, 1.0F);
  }
  step_ratio = std::clamp(step_ratio, 1 / config_.largest_step_ratio, config_.largest_step_ratio);
  // Up to the saturation limit and no further: a step up would only be taken back.
  if (step_ratio > 1 && 2 * decision.saturated_ratio > config_.saturated_limit_ratio) step_ratio = 1;
  if (step_ratio < config_.smallest_step_ratio && step_ratio > 1 / config_.smallest_step_ratio)
    return decision;
  const auto wanted = Nanoseconds{
      static_cast<std::int64_t>(static_cast<double>(exposure_.count()) * static_cast<double>(step_ratio))};
  const Nanoseconds next = std::clamp(wanted, config_.minimum, config_.maximum);
  decision.changed = next != exposure_;
  decision.exposure = exposure_ = next;
  if (decision.changed) profiles_since_step_ = 0;
  return decision;
}

}  // namespace biteline::pipeline
