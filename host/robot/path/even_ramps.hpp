// SPDX-License-Identifier: MIT
#pragma once
/// \file Accelerations without steps: a stretch's time law averaged over a window of time.

#include <span>
#include <vector>

namespace biteline::path {

/// Speeds, mm/s, of a stretch at places in order along it, lowered so that no mean over `window_s` of a
/// motion at them is above what is allowed at the places it lies between.
[[nodiscard]] std::vector<double> lowered_for_mean(std::span<const double> arc_mm,
                                                   std::span<const double> speed_mm_s, double window_s);

/// Time at each place, s from the first, and the speed there.
struct TimeLaw {
  std::vector<double> time_s, speed_mm_s;
};

/// From stop to stop: the motion that speeds changing evenly from place to place make, averaged over
/// `window_s`.  What swings in that time is left at rest by it, whatever steps the acceleration had (Singer
/// and Seering 1990).  Pre: three places or more, arcs rise, speeds are above 0 but at both ends.
[[nodiscard]] TimeLaw averaged(std::span<const double> arc_mm, std::span<const double> speed_mm_s,
                               double window_s);

}  // namespace biteline::path
