// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/scan_spread.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::uncertainty {
namespace {

// A line's point lies between profiles some millimetres apart; what no plane comes so near to was not
// scanned.
constexpr double k_most_off_plane_mm = 60;
// Pixels beyond the region: a bridged place may lie a little out of view.
constexpr double k_beside_region_px = 200;

bool in_view(const geometry::SensorModel& model, const Vec3& point_cam) {
  if (!(point_cam.z() > 1)) return false;
  const Vec2 pixel = model.camera.project(point_cam);
  const geometry::Region& region = model.region;
  const double u = pixel.x() - region.offset_u_px;
  const double v = pixel.y() - region.offset_v_px;
  return u > -k_beside_region_px && u < region.width_px + k_beside_region_px && v > -k_beside_region_px &&
         v < region.height_px + k_beside_region_px;
}

}  // namespace

ScanSpread::ScanSpread(const KnownHead& head, std::span<const ProfilePose> poses)
    : head_{head}, poses_{poses.begin(), poses.end()} {
  for (const ProfilePose& pose : poses_) {
    const SE3 T_base_cam = pose.T_base_flange * head_.model.T_flange_cam;
    const Vec3 normal = T_base_cam.linear() * head_.model.laser_plane.normal_cam;
    eyes_.push_back(
        {.T_base_cam = T_base_cam,
         .plane_normal_base = normal,
         .plane_distance_mm = head_.model.laser_plane.distance_mm + normal.dot(T_base_cam.translation())});
  }
}

std::ptrdiff_t ScanSpread::nearest_profile(const Vec3& point_base) const {
  std::ptrdiff_t nearest = -1;
  double least_mm = k_most_off_plane_mm;
  for (std::size_t i = 0; i < eyes_.size(); ++i) {
    const double off_mm = std::abs(eyes_[i].plane_normal_base.dot(point_base) - eyes_[i].plane_distance_mm);
    if (!(off_mm < least_mm) || !in_view(head_.model, eyes_[i].T_base_cam.inverse() * point_base)) continue;
    least_mm = off_mm;
    nearest = static_cast<std::ptrdiff_t>(i);
  }
  return nearest;
}

Vec3 ScanSpread::velocity_mm_s(std::size_t profile, const Vec3& point_flange) const {
  const ProfilePose& before = poses_[profile > 0 ? profile - 1 : profile];
  const ProfilePose& after = poses_[std::min(profile + 1, poses_.size() - 1)];
  const double seconds = after.time_s - before.time_s;
  if (!(seconds > 0)) return Vec3::Zero();
  return (after.T_base_flange * point_flange - before.T_base_flange * point_flange) / seconds;
}

Mat3 ScanSpread::covariance_mm2(const Vec3& point_base, double arm_sigma_mm) const {
  const std::ptrdiff_t profile = nearest_profile(point_base);
  if (profile < 0) return Mat3::Zero();
  const auto at = static_cast<std::size_t>(profile);
  const geometry::SensorModel& model = head_.model;
  const HeadUncertainty& known = head_.uncertainty;
  const SE3& T_base_flange = poses_[at].T_base_flange;
  const Vec3 point_flange = T_base_flange.inverse() * point_base;
  const Vec3 point_cam = model.T_flange_cam.inverse() * point_flange;
  const Mat3& R = T_base_flange.linear();
  // What the calibration has told wrong moves with the flange.  A clock that is late by so much has the arm
  // where it was before.
  Eigen::Matrix<double, 3, k_parameters> J =
      R * point_jacobian(model, known, model.camera.project(point_cam));
  J.col(k_clock_at) = velocity_mm_s(at, point_flange);
  const Mat3 lever = R * geometry::hat(point_flange);
  Mat3 pose_mm2 = known.pose_sigma_mm * known.pose_sigma_mm * Mat3::Identity() +
                  known.pose_sigma_rad * known.pose_sigma_rad * lever * lever.transpose();
  // What is stated of the poses is in what the scan shows, and is not added twice.
  const double more_mm2 = arm_sigma_mm * arm_sigma_mm - pose_mm2.trace() / 3;
  pose_mm2 += std::max(more_mm2, 0.0) * Mat3::Identity();
  return J * known.covariance * J.transpose() + pose_mm2;
}

}  // namespace biteline::uncertainty
