// SPDX-License-Identifier: MIT
#pragma once
/// \file Did the head move?  Two calibrations of one head, compared where it matters: at the working
/// distance.

#include "host/calibration/refine/head_bundle.hpp"

namespace biteline::calibration {

struct Comparison {
  double rms_mm{0};  ///< of points on the stripe, in the flange, between the two calibrations
  double largest_mm{0};
  Vec3 shift_flange_mm{Vec3::Zero()};  ///< mean
  double turn_rad{0};                  ///< of the camera on the flange
  double sigma_mm{0};                  ///< what the new calibration is good to there
  bool moved{false};                   ///< beyond three standard deviations of both, taken as equally good
};

/// The stripe over the whole width, 150 rows about its middle either way.
[[nodiscard]] Comparison compare_heads(const HeadFit& now, const geometry::SensorModel& before, int width_px);

}  // namespace biteline::calibration
