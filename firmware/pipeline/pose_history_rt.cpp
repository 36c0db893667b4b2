// SPDX-License-Identifier: MIT
#include "firmware/pipeline/pose_history.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/numbers.hpp"

namespace biteline::pipeline {
namespace {

constexpr double k_unit_tolerance = 1e-3;

SensorClock::time_point at_ns(std::int64_t stamp_ns) {
  return SensorClock::time_point{Nanoseconds{stamp_ns}};
}

}  // namespace

bool PoseHistory::rt_push(const geometry::PoseSample& sample) noexcept BITELINE_RT {
  // relaxed: only this thread writes count_.
  const std::uint64_t count = count_.load(std::memory_order_relaxed);
  if (count > 0 && sample.stamp <= rt_stamp_of(count - 1)) return false;
  const Eigen::Quaterniond rotation{sample.T_base_flange.linear()};
  const Eigen::Vector3d translation = sample.T_base_flange.translation();
  // Whatever sent it: a place beyond all arms, or no number, is no pose.
  if (!is_plausible_place(translation) || !(std::abs(rotation.norm() - 1) < k_unit_tolerance)) return false;
  slots_[count % k_capacity].rt_store(
      {.stamp_ns = sample.stamp.time_since_epoch().count(),
       .translation_mm = {translation.x(), translation.y(), translation.z()},
       .quaternion_xyzw = {rotation.x(), rotation.y(), rotation.z(), rotation.w()},
       .encoder_ticks = sample.encoder_ticks.value_or(0),
       .counted = sample.encoder_ticks ? 1U : 0U});
  count_.store(count + 1, std::memory_order_release);
  return true;
}

SensorClock::time_point PoseHistory::rt_stamp_of(std::uint64_t index) const noexcept BITELINE_RT {
  return at_ns(slots_[index % k_capacity].rt_load().stamp_ns);
}

SensorClock::time_point PoseHistory::rt_newest() const noexcept BITELINE_RT {
  const std::uint64_t count = count_.load(std::memory_order_acquire);
  return count == 0 ? SensorClock::time_point::min() : rt_stamp_of(count - 1);
}

bool PoseHistory::rt_covers(SensorClock::time_point instant,
                            const geometry::PoseSmoothing& smoothing) const noexcept BITELINE_RT {
  const std::uint64_t count = count_.load(std::memory_order_acquire);
  if (count == 0) return false;
  if (rt_newest() > instant + smoothing.reach) return true;
  // Enough samples after the instant, whatever their spacing?
  const auto needed = static_cast<std::uint64_t>(std::max(1, smoothing.samples_each_side));
  return count >= needed && rt_stamp_of(count - needed) >= instant;
}

bool PoseHistory::rt_pose_at(SensorClock::time_point instant, const geometry::PoseSmoothing& smoothing,
                             geometry::PoseEstimate& out) const noexcept BITELINE_RT {
  const std::uint64_t count = count_.load(std::memory_order_acquire);
  if (count == 0) return false;
  // The slot after the newest may be written at this moment: it counts as gone.
  const std::uint64_t oldest = count < k_capacity ? 0 : count - k_capacity + 1;

  // First sample not before the instant.
  std::uint64_t low = oldest, high = count;
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (rt_stamp_of(middle) < instant) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  constexpr std::uint64_t k_side = k_max_window / 2;
  const std::uint64_t first = low < oldest + k_side ? oldest : low - k_side;
  const std::uint64_t last = std::min(count, low + k_side);

  std::array<geometry::PoseSample, k_max_window> window;
  for (std::uint64_t i = first; i < last; ++i) {
    const Packed packed = slots_[i % k_capacity].rt_load();
    geometry::PoseSample& sample = window[i - first];
    sample.stamp = at_ns(packed.stamp_ns);
    sample.T_base_flange = SE3::Identity();
    sample.T_base_flange.linear() = Eigen::Quaterniond{packed.quaternion_xyzw[3], packed.quaternion_xyzw[0],
                                                       packed.quaternion_xyzw[1], packed.quaternion_xyzw[2]}
                                        .toRotationMatrix();
    sample.T_base_flange.translation() =
        Eigen::Vector3d{packed.translation_mm[0], packed.translation_mm[1], packed.translation_mm[2]};
    sample.encoder_ticks.reset();
    if (packed.counted != 0) sample.encoder_ticks = packed.encoder_ticks;
  }
  // Acquire loads of the words precede this one: had the writer begun to overwrite `first`, it would show
  // here.
  const std::uint64_t count_after = count_.load(std::memory_order_acquire);
  if (count_after >= first + k_capacity) return false;
  return geometry::rt_pose_at({window.data(), static_cast<std::size_t>(last - first)}, instant, smoothing,
                              out);
}

}  // namespace biteline::pipeline
