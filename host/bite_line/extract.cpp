// SPDX-License-Identifier: MIT
#include "host/bite_line/extract.hpp"

#include <algorithm>
#include <optional>

#include "host/bite_line/closing_steps.hpp"
#include "host/bite_line/live_scan.hpp"

namespace biteline::bite_line {

namespace {

/// The profiles' points lie together and rise: scan order as it is written.  A cloud may carry the numbers
/// and yet be in another order.
bool in_scan_order(const cloud::PointCloud& cloud) {
  return !cloud.points.empty() && cloud.profile.size() == cloud.size() &&
         std::is_sorted(cloud.profile.begin(), cloud.profile.end());
}

}  // namespace

Extraction extract(const cloud::PointCloud& cloud, const ExtractConfig& config,
                   const StageCallback& on_stage) {
  if (config.method == Method::Ours && in_scan_order(cloud)) {
    LiveScan scan;
    scan.add_profiles(cloud);
    return scan.finish(config, on_stage);
  }
  Extraction extraction;
  StageClock clock{extraction.stages, on_stage};
  const std::optional<Side> side = make_side(cloud.points, clock, extraction);
  if (!side) return extraction;
  const RawNear raw_near = [&](std::span<const std::uint32_t> near) {
    RawPoints raw;
    raw.points.reserve(near.size());
    for (const std::uint32_t i : near) raw.points.push_back(side->shoe.points[i]);
    return raw;
  };
  find_line(*side, cloud, config, raw_near, clock, extraction);
  return extraction;
}

}  // namespace biteline::bite_line
