// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/touch_lesson.hpp"

#include <algorithm>
#include <numbers>

namespace biteline::kinematics {
namespace {

// An arm that was not moved at all; one that was turned or moved on purpose is beyond both.
constexpr double k_same_mm = 0.5;
constexpr double k_same_rad = 0.5 * std::numbers::pi / 180;
constexpr double k_farthest_mm = 5000;  // of any arm's flange from its base

}  // namespace

void TouchLesson::begin(Part part, const Vec3& tip_flange) {
  part_ = part;
  tip_flange_ = tip_flange;
  touches_.clear();
}

Result<void> TouchLesson::add(const SE3& T_base_flange) {
  // Written so that a NaN is refused.
  if (!(T_base_flange.translation().norm() <= k_farthest_mm) || !T_base_flange.linear().allFinite())
    return fail(Errc::BadValue, "touch: a flange within %.0f mm of its base expected", k_farthest_mm);
  if (touches_.size() >= k_most_touches)
    return fail(Errc::WrongState, "touch: %zu touches are enough; save, or begin anew", touches_.size());
  const auto same = [&](const SE3& before) {
    return (before.translation() - T_base_flange.translation()).norm() < k_same_mm &&
           geometry::angle_between_rad(before.linear(), T_base_flange.linear()) < k_same_rad;
  };
  if (const auto found = std::ranges::find_if(touches_, same); found != touches_.end()) {
    return fail(Errc::WrongState, "touch: the arm stands as at touch %d; move it first",
                static_cast<int>(found - touches_.begin()) + 1);
  }
  touches_.push_back(T_base_flange);
  return {};
}

Result<Touched> TouchLesson::outcome() const {
  if (part_ == Part::Tip) {
    BITELINE_ASSIGN(const ToolTouch fit, fit_tool_touch(touches_, {}));
    return Touched{.tip_flange = fit.tip_flange, .residual_mm = fit.rms_mm, .u95_mm = fit.u95_mm};
  }
  std::vector<Vec3> tips;
  for (const SE3& T : touches_) tips.emplace_back(T * tip_flange_);
  BITELINE_ASSIGN(const TableTouch fit, fit_table_touch(tips, {}));
  return Touched{.z_mm = fit.z_mm, .residual_mm = fit.worst_mm, .u95_mm = fit.u95_mm};
}

}  // namespace biteline::kinematics
