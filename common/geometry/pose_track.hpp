// SPDX-License-Identifier: MIT
#pragma once
/// \file The robot's pose at an instant between stamped samples, smoothed.

#include <cstdint>
#include <optional>
#include <span>

#include "common/geometry/se3.hpp"
#include "common/time/clocks.hpp"

namespace biteline::geometry {

/// Encoder counts farther from zero are none: a double holds no farther whole number for sure.
inline constexpr std::int64_t k_most_ticks = std::int64_t{1} << 53;

/// A pose as stamped by its source, on the sensor's clock (clocks.hpp, to_sensor_clock).
struct PoseSample {
  SensorClock::time_point stamp;
  SE3 T_base_flange{SE3::Identity()};
  std::optional<std::int64_t> encoder_ticks{};  ///< where an encoder is the pose
};

/// How many samples one pose may be drawn from.
struct PoseSmoothing {
  static constexpr int k_max_each_side = 24;

  /// Most samples on each side of the instant; 1 turns smoothing off: plain interpolation between the two
  /// neighbours.
  int samples_each_side{k_max_each_side};
  /// Samples farther from the instant are never used, and a profile waits no longer than this for later ones.
  Nanoseconds reach{std::chrono::milliseconds{50}};
  /// A nearest sample farther away makes the pose stale.  Two periods of the slowest controller in use (125
  /// Hz).
  Nanoseconds stale_after{std::chrono::milliseconds{16}};
};

struct PoseEstimate {
  SE3 T_base_flange{SE3::Identity()};
  /// Body velocity: T(t + dt) = T(t) exp(velocity dt); mm/s and rad/s.
  Twist velocity_per_s{Twist::Zero()};
  /// Standard deviations of the estimate, from what the samples scatter about the fit: of the flange's place
  /// in one direction, and of its orientation about one axis.  0 where too few samples tell.
  double sigma_mm{0}, sigma_rad{0};
  Nanoseconds age{0};   ///< distance in time to the nearest sample
  int sample_count{0};  ///< samples the pose was drawn from
  /// Age above PoseSmoothing::stale_after, or so far beyond the samples that their noise is multiplied.
  bool stale{false};
  bool extrapolated{false};  ///< no sample on one side of the instant
  /// The encoder's count, linear between the two samples about the instant, to the nearest tick.  Nothing
  /// where one of them is missing or has none.
  std::optional<std::int64_t> encoder_ticks{};
};

/// Local polynomial regression on SE(3): the samples around `instant` are mapped to twists about a
/// neighbouring sample, a cubic in time is fitted by least squares in each coordinate, and its value at the
/// instant is mapped back.  Centred, hence without lag.  The window begins small, where a cubic follows any
/// motion an arm can make, and doubles as long as the wider fit's value agrees with the narrower one's within
/// their scatter (a chi-square test on the difference of nested fits): hence true motion is not rounded.
/// Savitzky, Golay 1964 for equal spacing; twists: Sola, Deray, Atchuthan 2018. With n samples each side
/// independent noise shrinks to about 3 / sqrt(8 n) of itself.
///
/// Pre: `samples` have strictly rising stamps.  False: there are none.  RT: yes.  Cost: some 10 us.
[[nodiscard]] bool rt_pose_at(std::span<const PoseSample> samples, SensorClock::time_point instant,
                              const PoseSmoothing& smoothing, PoseEstimate& out) noexcept;

}  // namespace biteline::geometry
