// SPDX-License-Identifier: MIT
#include "host/bite_line/live_scan.hpp"

#include <algorithm>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "common/core/contracts.hpp"
#include "host/bite_line/closing_steps.hpp"

namespace biteline::bite_line {

void LiveScan::add_profile(std::uint64_t sequence, std::span<const Eigen::Vector3f> points) {
  if (!sequences_.insert(sequence).second) return;
  profiles_.push_back({.sequence = sequence, .first_raw = raw_.size(), .points = points.size()});
  // Neighbours along the stripe are some 0.07 mm apart: their means over a quarter of a millimetre carry all
  // that finding the line needs.
  constexpr float k_run_mm = 0.25F;
  std::size_t i = 0;
  while (i < points.size()) {
    const auto first = static_cast<std::uint32_t>(raw_.size());
    const Eigen::Vector3f start = points[i];
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float count = 0;
    for (; i < points.size() && (points[i] - start).squaredNorm() < k_run_mm * k_run_mm; ++i) {
      sum += points[i] - start;
      count += 1;
      raw_.push_back(points[i]);
    }
    thinned_.points.push_back(start + sum / count);
    first_raw_.push_back(first);
  }
}

void LiveScan::add_profiles(const cloud::PointCloud& cloud) {
  BITELINE_EXPECTS(cloud.profile.size() == cloud.size());
  raw_.reserve(raw_.size() + cloud.size());
  for (std::size_t first = 0; first < cloud.size();) {
    std::size_t end = first;
    while (end < cloud.size() && cloud.profile[end] == cloud.profile[first]) ++end;
    add_profile(cloud.profile[first], {cloud.points.data() + first, end - first});
    first = end;
  }
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
  for (const Profile& profile : order)
    scan.add_profile(profile.sequence, {raw_.data() + profile.first_raw, profile.points});
  return scan;
}

Extraction LiveScan::finish(const ExtractConfig& config, const StageCallback& on_stage) const {
  // Rare, and sums in another order could tip a place that is hardly to be seen.
  if (!in_order()) return ordered().finish(config, on_stage);
  Extraction extraction;
  StageClock clock{extraction.stages, on_stage};
  const std::optional<Side> side = make_side(thinned_.points, clock, extraction);
  if (!side) return extraction;
  const RawNear raw_near = [&](std::span<const std::uint32_t> near) {
    RawPoints raw;
    raw.per_side_point = static_cast<double>(raw_.size()) / static_cast<double>(thinned_.size());
    const auto run_of = [&](std::size_t i) {
      const std::size_t run = side->shoe.index[near[i]];
      const std::size_t end = run + 1 < first_raw_.size() ? first_raw_[run + 1] : raw_.size();
      return std::span{raw_.data() + first_raw_[run], end - first_raw_[run]};
    };
    Large<std::size_t> first(near.size() + 1, 0);
    for (std::size_t i = 0; i < near.size(); ++i) first[i + 1] = first[i] + run_of(i).size();
    raw.points.resize(first.back());
    const Eigen::Isometry3f T_shoe_base = side->shoe.T_base_shoe.inverse().cast<float>();
    tbb::parallel_for(tbb::blocked_range<std::size_t>{0, near.size(), 4096}, [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        Eigen::Vector3f* to = raw.points.data() + first[i];
        for (const Eigen::Vector3f& p : run_of(i)) *to++ = T_shoe_base * p;
      }
    });
    return raw;
  };
  find_line(*side, thinned_, config, raw_near, clock, extraction);
  return extraction;
}

}  // namespace biteline::bite_line
