// SPDX-License-Identifier: MIT
#pragma once
/// \file Exposure that follows the surface: from the share of valid and of saturated columns.

#include "common/profile/profile.hpp"
#include "common/rt/annotations.hpp"

namespace biteline::pipeline {

/// Proposes the next exposure after each profile.
///
/// The light of a stripe is proportional to the exposure, so one step brings the typical amplitude to the
/// target, but for two things: saturated columns tell nothing about how much too bright they are, so a share
/// of them above the limit cuts the exposure by a fixed factor; and hardly any valid column means either
/// darkness or no surface, which a longer exposure tells apart, so it doubles up to its limit.  Steps are
/// limited and small ones left out: a camera needs a frame or two to follow, and an exposure that hunts gives
/// stripes of changing height. Thread: one.  RT: rt_ members.
class ExposureControl {
 public:
  struct Config {
    Nanoseconds minimum{std::chrono::microseconds{20}};
    Nanoseconds maximum{std::chrono::milliseconds{4}};  ///< at 250 mm/s a millimetre of motion blur
    float target_amplitude{150};  ///< of the middle valid column, grey levels: bright, with room for speckle
    float saturated_limit_ratio{0.05F};  ///< of the valid columns
    float valid_least_ratio{0.05F};      ///< of all columns
    float largest_step_ratio{2.0F};
    float smallest_step_ratio{1.15F};  ///< a smaller change is not worth the camera's trouble
    int profiles_between_steps{3};
  };

  struct Decision {
    Nanoseconds exposure{0};
    bool changed{false};
    float valid_ratio{0};      ///< columns with a surface point
    float saturated_ratio{0};  ///< of those, saturated
    float amplitude{0};        ///< median over the valid columns
  };

  ExposureControl(const Config& config, Nanoseconds start) : config_{config}, exposure_{start} {}

  /// Pre: `column_count` > 0.
  [[nodiscard]] Decision rt_update(const profile::ProfileBuffer& profile,
                                   int column_count) noexcept BITELINE_RT;

 private:
  Config config_;
  Nanoseconds exposure_;
  int profiles_since_step_{0};
};

}  // namespace biteline::pipeline
