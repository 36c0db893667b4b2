// SPDX-License-Identifier: MIT
#include "host/intake/whole_scan.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include "host/bite_line/scan_points.hpp"

namespace biteline::intake {
namespace {

/// Of each profile's runs, as a line's own scan is looked at.
uncertainty::ArmSway sway_of(const cloud::PointCloud& cloud, std::span<const TakenFrom> poses) {
  uncertainty::ArmSway sway;
  const std::span<const Eigen::Vector3f> points{cloud.points};
  std::vector<Eigen::Vector3f> means;
  std::size_t first = 0;
  for (const TakenFrom& taken : poses) {
    const auto from = std::lower_bound(cloud.profile.begin() + static_cast<std::ptrdiff_t>(first),
                                       cloud.profile.end(), taken.profile);
    const auto until = std::upper_bound(from, cloud.profile.end(), taken.profile);
    first = static_cast<std::size_t>(until - cloud.profile.begin());
    const auto begin = static_cast<std::size_t>(from - cloud.profile.begin());
    const auto own = points.subspan(begin, first - begin);
    means.clear();
    for (std::size_t at = 0; at < own.size();) {
      const bite_line::Run run = bite_line::run_from(own, at);
      means.push_back(run.mean);
      at = run.end;
    }
    sway.add_profile(means, taken.pose);
  }
  return sway;
}

}  // namespace

uncertainty::WholeScan whole_scan_of(const ScanOutcome& scan,
                                     const std::optional<uncertainty::HeadUncertainty>& head,
                                     const std::optional<uncertainty::ArmGive>& earlier) {
  uncertainty::WholeScan whole;
  if (scan.poses.empty() || !scan.cloud.organised()) return whole;
  const uncertainty::ArmSway sway = sway_of(scan.cloud, scan.poses);
  whole.arm = sway.motion();
  if (!whole.arm) whole.arm = sway.motion_by(uncertainty::give_of(head, earlier));
  if (!head) return whole;
  std::vector<uncertainty::ProfilePose> poses;
  for (const TakenFrom& taken : scan.poses) poses.push_back(taken.pose);
  whole.head.emplace(uncertainty::KnownHead{.model = scan.sensor.model, .uncertainty = *head}, poses);
  return whole;
}

}  // namespace biteline::intake
