// SPDX-License-Identifier: MIT
#pragma once
/// \file Scans at a share of real time, on a machine that is too slow or too busy for the whole of it.
///
/// The arm's way of a scan and the trigger are stretched together, as by a controller's speed slider, so the
/// profiles lie where they would.  Stamps, the controller's rate and all protocols stay in real time.

#include <functional>

#include "common/time/clocks.hpp"
#include "hal/sim/robot/arm.hpp"

namespace biteline::sim {

/// Pictures come no slower than that: the laser's guard takes a camera for silent after 75 ms.
inline constexpr Nanoseconds k_slowest_period{50'000'000};

/// Share of real time, at most 1, at which a picture may take half of the time until the next one; no less
/// than k_slowest_period permits.
[[nodiscard]] double affordable_ratio(Nanoseconds picture, Nanoseconds period);

/// Mean time of a call, on the calling thread and with its priority: what this machine gives it now.  One
/// call more goes before: the first one makes memory.
[[nodiscard]] Nanoseconds mean_turn(int turns, const std::function<void(int turn)>& work);

/// The same motion in 1 / `ratio` of its time.
[[nodiscard]] FlangeMotion slowed(FlangeMotion motion, double ratio);

}  // namespace biteline::sim
