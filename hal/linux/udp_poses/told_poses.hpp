// SPDX-License-Identifier: MIT
#pragma once
/// \file From told poses to pose samples: rising stamps, losses, and the controller's clock on ours.

#include <cstdint>
#include <optional>

#include "hal/api/pose_source.hpp"
#include "hal/linux/udp_poses/told_pose.hpp"
#include "hal/timing/clock_map.hpp"

namespace biteline::hal {

/// Thread: one owner.  Memory: fixed.
class ToldPoses {
 public:
  /// The sample; nothing: told again, or older than one before.  A controller whose clock was set back is
  /// believed once its clock's map has seen so.
  [[nodiscard]] std::optional<RobotPose> accept(const ToldPose& told, SensorClock::time_point received);

  /// Nobody spoke for long: who begins anew with an earlier stamp is believed at once, its clock's map too.
  void note_silence() { silent_ = true; }

  [[nodiscard]] std::uint64_t poses() const { return poses_; }
  [[nodiscard]] std::uint64_t lost() const {
    return lost_;
  }  ///< gaps in the controller's own count or stamps
  [[nodiscard]] std::uint64_t rejected() const { return rejected_; }
  [[nodiscard]] ClockMapHealth clock_health() const { return clock_.health(); }

 private:
  /// How many messages on from the last one; 1: the next, or not known.
  [[nodiscard]] std::uint64_t steps_to(const ToldPose& told);

  ClockMap<RobotClock> clock_;
  std::optional<ToldPose> last_;
  Nanoseconds period_{Nanoseconds::max()};  ///< the least step seen
  bool silent_{false};
  std::uint64_t sequence_{0}, poses_{0}, lost_{0}, rejected_{0};
};

}  // namespace biteline::hal
