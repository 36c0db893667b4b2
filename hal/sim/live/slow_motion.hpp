// SPDX-License-Identifier: MIT
#pragma once
/// \file Scans at a share of real time, on a machine that is too slow or too busy for the whole of it.
///
/// The arm's way of a scan and the trigger are stretched together, as by a controller's speed slider, so the
/// profiles lie where they would.  Stamps, the controller's rate and all protocols stay in real time.

#include <atomic>
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

/// Which share of real time the next scan gets.  Thread: late_by() from any, the others from one.
class TimeShare {
 public:
  /// A picture later than that may look to the sensor like a dead camera.
  static constexpr Nanoseconds k_most_late{25'000'000};

  /// `ratio`: of the first scan; `period`: of the pictures asked for.
  TimeShare(double ratio, Nanoseconds period);
  [[nodiscard]] double ratio() const { return ratio_; }
  /// A picture is begun so long after its exposure.
  void late_by(Nanoseconds late);
  /// Before each scan: half as fast where the last one's pictures came too late.  True: slower than before.
  bool settle();

 private:
  std::atomic<double> ratio_;
  double slowest_;
  std::atomic<std::int64_t> worst_late_ns_{0};
};

/// The same motion in 1 / `ratio` of its time.
[[nodiscard]] FlangeMotion slowed(FlangeMotion motion, double ratio);

}  // namespace biteline::sim
