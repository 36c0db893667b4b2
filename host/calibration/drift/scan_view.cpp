// SPDX-License-Identifier: MIT
#include "host/calibration/drift/scan_view.hpp"

#include <algorithm>

namespace biteline::drift {
namespace {

/// A profile from where the arm was at the one before says nothing new, and an arm that stands takes
/// thousands of them.
constexpr double k_least_way_mm = 0.2, k_arm_mm = 200;
std::vector<bool> moved_on(std::span<const PosedProfile> poses) {
  std::vector<bool> moved(poses.size(), true);
  std::size_t last = 0;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const SE3& from = poses[last].pose.T_base_flange;
    const SE3& to = poses[k].pose.T_base_flange;
    const double way_mm =
        (to.translation() - from.translation()).norm() + k_arm_mm * (to.linear() - from.linear()).norm();
    moved[k] = !(way_mm < k_least_way_mm);
    if (moved[k]) last = k;
  }
  return moved;
}

}  // namespace

std::vector<std::uint32_t> frames_of(const ScanView& scan) {
  std::vector<std::uint32_t> frames(scan.points_base.size(), k_no_frame);
  const std::vector<bool> moved = moved_on(scan.poses);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto found = std::ranges::lower_bound(scan.poses, scan.profile[i], {}, &PosedProfile::profile);
    const bool known = found != scan.poses.end() && found->profile == scan.profile[i];
    constexpr float k_far_mm = 1e5;
    if (!known || !moved[static_cast<std::size_t>(found - scan.poses.begin())]) continue;
    if (scan.points_base[i].allFinite() && scan.points_base[i].cwiseAbs().maxCoeff() < k_far_mm)
      frames[i] = static_cast<std::uint32_t>(found - scan.poses.begin());
  }
  return frames;
}

Vec3 velocity_mm_s(std::span<const PosedProfile> poses, std::size_t frame, const Vec3& point_base) {
  const auto& before = poses[frame > 0 ? frame - 1 : frame].pose;
  const auto& after = poses[std::min(frame + 1, poses.size() - 1)].pose;
  const double seconds = after.time_s - before.time_s;
  if (!(seconds > 0)) return Vec3::Zero();
  const Vec3 point_flange = poses[frame].pose.T_base_flange.inverse() * point_base;
  return (after.T_base_flange * point_flange - before.T_base_flange * point_flange) / seconds;
}

}  // namespace biteline::drift
