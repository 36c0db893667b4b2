// SPDX-License-Identifier: MIT
#include "host/bite_line/live_scan.hpp"

#include <algorithm>
#include <utility>

namespace biteline::bite_line {
namespace {

/// Of an arm that a scan does not show.
uncertainty::ArmGive known_give(const Config& config) {
  return uncertainty::give_of(config.head != nullptr ? std::optional{config.head->uncertainty} : std::nullopt,
                              config.arm_give);
}

}  // namespace

void LiveScan::add_profile(std::uint64_t sequence, std::span<const Eigen::Vector3f> points,
                           const std::optional<uncertainty::ProfilePose>& pose,
                           const cloud::StripeSpan& stripe) {
  if (!sequences_.insert(sequence).second) return;
  const std::size_t first_mean = means_.size();
  profiles_.push_back({.sequence = sequence,
                       .first_raw = raw_.size(),
                       .points = points.size(),
                       .first_run = first_mean,
                       .pose = pose});
  const bool has_look = stripe.amplitude.size() == points.size() && !points.empty();
  if (has_look) looks_.resize(first_mean);
  for (std::size_t first = 0; first < points.size();) {
    const Run run = run_from(points, first);
    means_.push_back(run.mean);
    first_raw_.push_back(static_cast<std::uint32_t>(raw_.size() + first));
    if (has_look) looks_.push_back(look_of(stripe.part(first, run.end - first)));
    first = run.end;
  }
  if (!looks_.empty()) looks_.resize(means_.size());
  raw_.insert(raw_.end(), points.begin(), points.end());
  if (pose) arm_.add_profile(std::span{means_}.subspan(first_mean), *pose);
}

bool LiveScan::in_order() const {
  return std::is_sorted(profiles_.begin(), profiles_.end(),
                        [](const Profile& a, const Profile& b) { return a.sequence < b.sequence; });
}

LiveScan LiveScan::ordered() const {
  std::vector<Profile> order = profiles_;
  std::sort(order.begin(), order.end(),
            [](const Profile& a, const Profile& b) { return a.sequence < b.sequence; });
  LiveScan scan;
  for (const Profile& profile : order) {
    const std::size_t first_run = scan.means_.size();
    scan.add_profile(profile.sequence, {raw_.data() + profile.first_raw, profile.points}, profile.pose);
    if (looks_.empty()) continue;
    scan.looks_.resize(first_run);  // without the unknown ones that came with no stripe
    const auto from = looks_.begin() + static_cast<std::ptrdiff_t>(profile.first_run);
    scan.looks_.insert(scan.looks_.end(), from,
                       from + static_cast<std::ptrdiff_t>(scan.means_.size() - first_run));
  }
  return scan;
}

Extraction LiveScan::finish(const Config& config, std::optional<Workings>* workings) const {
  // Rare, and sums in another order could tip a place that is hardly to be seen.
  if (!in_order()) return ordered().finish(config, workings);
  std::vector<uncertainty::ProfilePose> poses;
  for (const Profile& profile : profiles_) {
    if (profile.pose && profile.points > 0) poses.push_back(*profile.pose);
  }
  std::optional<uncertainty::ArmMotion> arm = arm_.motion();
  if (!arm) arm = arm_.motion_by(known_give(config));
  return find_bite_line({.means = means_,
                         .points = raw_,
                         .first_point = first_raw_,
                         .poses = poses,
                         .arm = std::move(arm),
                         .looks = looks_,
                         .in_scan_order = true},
                        config, workings);
}

}  // namespace biteline::bite_line
