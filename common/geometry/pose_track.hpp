// SPDX-License-Identifier: MIT
#pragma once
/// \file The robot's pose at an instant between stamped samples, smoothed.

#include <span>

#include "common/geometry/se3.hpp"
#include "common/time/clocks.hpp"

namespace biteline::geometry {

/// A pose as stamped by its source, on the sensor's clock (clocks.hpp, to_sensor_clock).
struct PoseSample {
  SensorClock::time_point stamp;
  SE3 T_base_flange{SE3::Identity()};
};

/// How many samples one pose may be drawn from.
struct PoseSmoothing {
  /// Samples on each side of the instant; 0 turns smoothing off: plain interpolation between the two neighbours.
  int samples_each_side{k_max_each_side};
  /// Samples farther from the instant are never used.  A robot's motion bends over some 20 ms (its jerk limit): beyond,
  /// a polynomial of low degree rounds it.
  Nanoseconds reach{std::chrono::milliseconds{24}};
  /// A nearest sample farther away makes the pose stale.  Two periods of the slowest controller in use (125 Hz).
  Nanoseconds stale_after{std::chrono::milliseconds{16}};

  static constexpr int k_max_each_side = 12;
};

struct PoseEstimate {
  SE3 T_base_flange{SE3::Identity()};
  /// Body velocity: T(t + dt) = T(t) exp(velocity dt); mm/s and rad/s.
  Twist velocity_per_s{Twist::Zero()};
  Nanoseconds age{0};      ///< distance in time to the nearest sample
  int sample_count{0};     ///< samples the pose was drawn from
  bool stale{false};       ///< age above PoseSmoothing::stale_after
  bool extrapolated{false};///< no sample on one side of the instant
};

/// Local polynomial regression on SE(3): the samples around `instant` are mapped to twists about the interpolated pose,
/// a cubic in time is fitted by least squares in each coordinate, and its value at the instant is mapped back.  Centred,
/// hence without lag; exact for any motion whose twist is cubic over the window, hence without rounding of one that is
/// not exactly cubic, since the window shrinks until the fit's residuals show nothing but noise.  Savitzky, Golay 1964
/// for equal spacing; on a Lie group: Sola 2018, eq. (41) to (43).  Independent noise of the samples shrinks to about
/// 3 / sqrt(8 n) of itself for n samples each side.
///
/// Pre: `samples` have strictly rising stamps.  False: there are none.  RT: yes.  Cost: some microseconds.
[[nodiscard]] bool rt_pose_at(std::span<const PoseSample> samples, SensorClock::time_point instant,
                              const PoseSmoothing& smoothing, PoseEstimate& out) noexcept;

}  // namespace biteline::geometry
