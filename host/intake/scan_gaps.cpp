// SPDX-License-Identifier: MIT
#include "host/intake/scan_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "host/geometry/robust.hpp"

namespace biteline::intake {
namespace {

constexpr std::size_t k_least_profiles = 10;
// Of ten steps nine are no longer than the usual one: dark frames between and brackets lengthen some of them
// regularly, losses only a few.
constexpr double k_usual_share = 0.9;

std::uint64_t missing(std::uint64_t before, std::uint64_t after) {
  return after > before + 1 ? after - before - 1 : 0;
}

}  // namespace

void ScanGaps::add(const profile::ProfileHeader& header) {
  if (begun_) {
    gap_.profiles = std::max(gap_.profiles, missing(last_.sequence, header.sequence));
    if ((header.flags & profile::k_profile_frame_gap) != 0)
      gap_.frames = std::max(gap_.frames, missing(last_.frame_sequence, header.frame_sequence));
    steps_ns_.push_back((header.exposure_mid - last_.exposure_mid).count());
  } else {
    gap_.profiles = header.sequence;  // those before the first that came
  }
  begun_ = true;
  last_ = header;
}

LongestGap ScanGaps::longest() const {
  LongestGap gap = gap_;
  if (steps_ns_.size() < k_least_profiles) return gap;
  std::vector<std::int64_t> steps_ns = steps_ns_;
  const std::int64_t usual_ns = geometry::quantile_of(std::span{steps_ns}, k_usual_share);
  // A head that follows the stripe is quicker than its setting for most of a scan, and slower while it
  // searches.
  const double period_ns = std::max(static_cast<double>(usual_ns), rate_hz_ > 0 ? 1e9 / rate_hz_ : 0.0);
  const double longest_ns = static_cast<double>(*std::ranges::max_element(steps_ns_));
  if (period_ns > 0 && longest_ns > period_ns)
    gap.edges = static_cast<std::uint64_t>(std::llround(longest_ns / period_ns) - 1);
  return gap;
}

}  // namespace biteline::intake
