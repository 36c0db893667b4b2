// SPDX-License-Identifier: MIT
#pragma once
/// \file What an arm told of its force while it followed a path that presses.

#include <optional>
#include <span>

#include "host/robot/path/force_learning.hpp"
#include "host/robot/path/track.hpp"

namespace biteline::path {

/// A force within this share of the set one is as it should be.
inline constexpr double k_force_band_ratio = 0.15;

/// Of the line between the ramps, by the arm's own sensor, its learned error taken off.  The reading goes
/// through a lag of 50 ms: it shakes with the tool.
struct ForceTold {
  std::size_t samples{0};
  double within{0};  ///< share of the samples within k_force_band_ratio
  double mean_newton{0}, rms_off_newton{0};
  double least_newton{0}, largest_newton{0};
  /// Mean of the tip from its planned place, along the force: farther in with each shoe as the tool wears.
  double along_mm{0};
  /// For learn_shoe(); of all runs as if the sensor had been zeroed at the first one's beginning.
  std::vector<ForceSample> learn{};
  ShoePlace place{};
};

/// Nothing: the path does not press, or no reading came while it did.
[[nodiscard]] std::optional<ForceTold> force_told(const PlannedPath& path, std::span<const TrackSample> track,
                                                  const ForceLearned& learned);

/// Of a path with its tool off (first_run.hpp, force_air_run()): what the sensor told on the line.
[[nodiscard]] std::vector<ForceSample> air_told(const PlannedPath& path, std::span<const TrackSample> track);

}  // namespace biteline::path
