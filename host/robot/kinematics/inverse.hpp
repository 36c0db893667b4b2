// SPDX-License-Identifier: MIT
#pragma once
/// \file From a flange pose to all joint sets that reach it.

#include <span>

#include "host/robot/kinematics/arm_model.hpp"

namespace biteline::kinematics {

/// Shoulder left or right, wrist up or down, elbow up or down: bits 0, 1, 2 of the number.
using Branch = std::uint8_t;
constexpr std::size_t k_branches = 8;

struct Solution {
  Joints q_rad;  ///< each in (-pi, pi]
  Branch branch{0};
};

/// Without heap.  The nominal arm has at most eight; where two of its branches meet, a calibrated one may
/// have more (any arm of six turning joints has at most sixteen).
class Solutions {
 public:
  [[nodiscard]] bool full() const { return count_ == solutions_.size(); }
  void add(const Solution& solution) { solutions_[count_++] = solution; }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] const Solution* begin() const { return solutions_.data(); }
  [[nodiscard]] const Solution* end() const { return solutions_.data() + count_; }
  [[nodiscard]] const Solution& operator[](std::size_t i) const { return solutions_[i]; }

 private:
  std::array<Solution, 2 * k_branches> solutions_;
  std::size_t count_{0};
};

struct InverseOptions {
  double q6_hint_rad{0};    ///< q6 in the wrist singularity, where q4 and q6 share one angle
  bool search_folds{true};  ///< calibrated arms: look for more solutions where two branches meet (3 ms there)
};

/// Every solution of the pose.
///
/// Closed form on the nominal lengths; for a calibrated arm each branch is then refined by damped Newton
/// steps on the calibrated chain until the pose is met to 1e-7 mm and 1e-10 rad.  Where two branches meet in
/// a fold, steps start on both sides of it.  Of calibrated arms a solution within 0.001 of a singularity may
/// still be missed (1 to 2 of 10 000 random poses, see the benchmark); a path has no business there.
[[nodiscard]] Solutions inverse(const ArmModel& arm, const SE3& T_base_flange,
                                const InverseOptions& options = {});

/// The angle's twin (plus or minus whole turns) nearest to `reference_rad`.
[[nodiscard]] double nearest_turn(double angle_rad, double reference_rad);

/// The links meet at a straight fold, so the elbow never crosses pi.
inline constexpr int k_elbow = 2;

/// The posture's twin by whole turns nearest to `reference_rad`, each joint `margin_rad` within its limits;
/// the elbow stays as it is.
[[nodiscard]] Joints nearest_turns(Joints q_rad, const Joints& reference_rad, const JointLimits& limits,
                                   double margin_rad);

}  // namespace biteline::kinematics
