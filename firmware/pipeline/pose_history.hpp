// SPDX-License-Identifier: MIT
#pragma once
/// \file The last few seconds of robot poses, written by one thread, looked up by others.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "common/geometry/pose_track.hpp"
#include "common/rt/annotations.hpp"
#include "common/rt/word_copy.hpp"

namespace biteline::pipeline {

/// Ring of the newest poses; the oldest is overwritten, readers notice.
///
/// Sequence lock over the whole ring: a reader copies the samples around its instant and then checks that the
/// writer has not come round to them meanwhile.  Thread: one writer (rt_push), any readers.  RT: all members.
class PoseHistory {
 public:
  static constexpr std::size_t k_capacity = 4096;  ///< 8 s at 500 Hz
  static constexpr std::size_t k_max_window = 2 * geometry::PoseSmoothing::k_max_each_side;

  /// False: `sample` is not later than the newest; it is dropped.
  bool rt_push(const geometry::PoseSample& sample) noexcept BITELINE_RT;

  /// Latest stamp; time_point::min() when empty.
  [[nodiscard]] SensorClock::time_point rt_newest() const noexcept BITELINE_RT;

  /// False: empty, or the instant is older than the ring.  `out` as of geometry::rt_pose_at().
  [[nodiscard]] bool rt_pose_at(SensorClock::time_point instant, const geometry::PoseSmoothing& smoothing,
                                geometry::PoseEstimate& out) const noexcept BITELINE_RT;

  /// True when the window around `instant` is complete: later poses would not change the estimate.
  [[nodiscard]] bool rt_covers(SensorClock::time_point instant,
                               const geometry::PoseSmoothing& smoothing) const noexcept BITELINE_RT;

 private:
  /// What a slot holds: 80 bytes instead of a sample's 168.
  struct Packed {
    std::int64_t stamp_ns;
    std::array<double, 3> translation_mm;
    std::array<double, 4> quaternion_xyzw;
    std::int64_t encoder_ticks;
    std::uint64_t counted;  ///< 0: no count
  };
  [[nodiscard]] SensorClock::time_point rt_stamp_of(std::uint64_t index) const noexcept BITELINE_RT;

  std::atomic<std::uint64_t> count_{0};  ///< poses ever pushed; the slot of index i is i % k_capacity
  std::array<rt::AtomicWords<Packed>, k_capacity> slots_;
};

}  // namespace biteline::pipeline
