// SPDX-License-Identifier: MIT
#pragma once
/// \file The head's way round the shoe as the arm's joints go it: within their limits, touching nothing.

#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "hal/sim/motion/scan_path.hpp"
#include "hal/sim/render/made_head.hpp"
#include "hal/sim/robot/arm_kinematics.hpp"

namespace biteline::sim {

/// What stands around: all that the arm and its head may not touch.
struct ScanPlace {
  SE3 T_base_shoe{SE3::Identity()};  ///< the table is the plane under the shoe
  double top_z_mm{64};               ///< of the shoe, above the table
  bool clockwise{false};             ///< from the path's end to its begin
};

/// The stripe goes along the outline at the path's speed, and slower where a joint's speed or acceleration
/// asks for it.  It sets out from rest before the path's begin and is at rest again behind its end.
/// Immutable after plan().
class ArmScan {
 public:
  /// Tries the arm's postures and takes the quickest.  Errc::OutOfReach names what stands in the way, and
  /// where: out of reach, a joint's limit, what would be touched.
  [[nodiscard]] static Result<ArmScan> plan(const ScanPath& path, const MadeHead& head,
                                            const ArmKinematics& arm, const ScanPlace& place);

  [[nodiscard]] double duration_s() const { return time_s_.back(); }
  /// Clamped to both ends.
  [[nodiscard]] JointVector q_rad_at(double time_s) const;
  /// Above the begin and above the end, clear of the shoe's top.
  [[nodiscard]] const JointVector& above_begin_rad() const { return above_begin_rad_; }
  [[nodiscard]] const JointVector& above_end_rad() const { return above_end_rad_; }
  /// Where the stripe is on the path from its begin to its end: the scan proper.  With a check lap what the
  /// arm passes while it sets out and stops belongs to it.
  [[nodiscard]] double full_from_s() const { return full_from_s_; }
  [[nodiscard]] double full_until_s() const { return full_until_s_; }
  /// Of the stripe within the scan proper.
  [[nodiscard]] double slowest_mm_s() const { return slowest_mm_s_; }

 private:
  ArmScan() = default;
  void set_times(double lead_mm, double length_mm);
  /// By how much a controller's cycles behind each sample would ask too much of a joint: slower by this they
  /// do not.
  [[nodiscard]] std::vector<double> overloads(const JointLimits& limits) const;
  /// As fast as the joints can take it.
  void take_speeds(const JointLimits& limits, double speed_mm_s, double lead_mm, double length_mm);
  /// The scan proper then holds the ramps, too.
  void see_ramps();
  /// Where the way's place `place`, counted in samples, comes by.
  [[nodiscard]] double time_of_s(double place) const;

  std::vector<JointVector> q_rad_;  ///< every k_step_mm of the way
  std::vector<double> speed_mm_s_, time_s_;
  JointVector above_begin_rad_{JointVector::Zero()}, above_end_rad_{JointVector::Zero()};
  double full_from_s_{0}, full_until_s_{0}, slowest_mm_s_{0};
};

/// From rest to rest, all joints together, each within its limits.
class JointEase {
 public:
  JointEase(const JointVector& from_rad, const JointVector& to_rad, const JointLimits& limits);
  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] JointVector q_rad_at(double time_s) const;

 private:
  JointVector from_rad_, to_rad_;
  double duration_s_{0};
};

}  // namespace biteline::sim
