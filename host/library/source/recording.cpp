// SPDX-License-Identifier: MIT
#include "biteline/recording.hpp"

#include "host/intake/recorded_scan.hpp"
#include "host/library/source/inside.hpp"

namespace biteline::sdk {
namespace {

Profile from_inside(const profile::Profile& profile) {
  Profile out;
  out.sequence = profile.header.sequence;
  out.exposure_mid_ns = profile.header.exposure_mid.time_since_epoch().count();
  out.usable = (profile.header.flags & profile::k_profile_not_usable) == 0;
  for (const profile::ProfilePoint& point : profile.points) {
    out.points_cam_mm.push_back(point.point_cam);
    out.sigma_mm.push_back(point.sigma_mm);
    out.column_px.push_back(point.column);
  }
  return out;
}

}  // namespace

Recording read_recording(const std::filesystem::path& file) {
  std::vector<Profile> profiles;
  std::vector<SE3> poses;
  intake::RecordedScan scan = or_throw(intake::read_recorded_scan(
      file, [&](const profile::Profile& profile, std::span<const Eigen::Vector3f>, const cloud::StripeSpan&) {
        profiles.push_back(from_inside(profile));
        poses.push_back(profile.header.T_base_flange);
      }));
  for (std::size_t i = 0; i < profiles.size(); ++i)
    profiles[i].T_base_cam = from_inside(poses[i] * scan.run.sensor.model.T_flange_cam);
  if (scan.run.cloud.points.empty())
    throw Error{file.string() + ": no usable point", "scan again with poses, and a shoe in sight"};
  return {.head = make_head(scan.run.sensor.model),
          .profiles = std::move(profiles),
          .cloud = make_cloud(std::move(scan.run.cloud)),
          .lacks = scan.lacks.value_or("")};
}

}  // namespace biteline::sdk
