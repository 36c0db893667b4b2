// SPDX-License-Identifier: MIT
#include "firmware/pipeline/region_follower.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::pipeline {
namespace {

/// A region this much larger than needed is worth a change.
constexpr double k_worth_ratio = 1.25;

}  // namespace

RegionFollower::RegionFollower(const Config& config)
    : config_{config},
      first_row_px_{config.first_row_px},
      end_row_px_{config.end_row_px},
      seen_first_px_{config.end_row_px},
      seen_end_px_{config.first_row_px} {}

RegionFollower::Proposal RegionFollower::rt_propose(int first_row_px, int end_row_px,
                                                    bool searching) noexcept BITELINE_RT {
  // In steps from the first row that it may show.
  const int step = config_.step_px, whole = config_.end_row_px - config_.first_row_px;
  int first = std::max(0, first_row_px - config_.first_row_px) / step * step;
  int end = std::min(whole, (end_row_px - config_.first_row_px + step - 1) / step * step);
  if (end - first < config_.least_height_px) {
    const int middle = (first + end) / 2;
    first =
        std::clamp(middle - config_.least_height_px / 2, 0, std::max(0, whole - config_.least_height_px)) /
        step * step;
    end = std::min(whole, first + config_.least_height_px);
  }
  first += config_.first_row_px;
  end += config_.first_row_px;
  const bool changed = first != first_row_px_ || end != end_row_px_;
  if (changed) {
    first_row_px_ = first;
    end_row_px_ = end;
    seen_first_px_ = config_.end_row_px;
    seen_end_px_ = config_.first_row_px;
    profiles_too_large_ = 0;
  }
  searching_ = searching;
  const Nanoseconds period = config_.frame_overhead + (end - first) * config_.row_time;
  return {.offset_v_px = first,
          .height_px = end - first,
          .changed = changed,
          .searching = searching,
          .rate_max_hz = 1e9 / static_cast<double>(period.count())};
}

RegionFollower::Proposal RegionFollower::rt_update(const profile::ProfileBuffer& profile) noexcept
    BITELINE_RT {
  if (profile.header.flags & profile::k_profile_stripe_lost) {
    if (++profiles_lost_ >= config_.profiles_to_lose)
      return rt_propose(config_.first_row_px, config_.end_row_px, true);
    return rt_propose(first_row_px_, end_row_px_, searching_);
  }
  profiles_lost_ = 0;
  int first = config_.end_row_px, end = config_.first_row_px;
  bool clipped = false;
  for (const profile::ProfilePoint& point : profile.view()) {
    if (point.flags & profile::k_point_reflection) continue;
    const float half_px = point.width_px;  // down to a hundredth of the height
    first = std::min(first, static_cast<int>(std::floor(point.row_px - half_px)));
    end = std::max(end, static_cast<int>(std::ceil(point.row_px + half_px)) + 1);
    clipped = clipped || (point.flags & profile::k_point_clipped) != 0;
  }
  if (end <= first) return rt_propose(first_row_px_, end_row_px_, searching_);
  seen_first_px_ = std::min(seen_first_px_, first);
  seen_end_px_ = std::max(seen_end_px_, end);

  const int wanted_first = seen_first_px_ - config_.margin_px, wanted_end = seen_end_px_ + config_.margin_px;
  // The stripe nears an edge: room on that side at once.  Half of the margin is what it may use up.
  const bool near_first =
      first_row_px_ > config_.first_row_px && first < first_row_px_ + config_.margin_px / 2;
  const bool near_end = end_row_px_ < config_.end_row_px && end > end_row_px_ - config_.margin_px / 2;
  if (clipped || near_first || near_end) {
    return rt_propose(std::min(first_row_px_, wanted_first), std::max(end_row_px_, wanted_end), false);
  }
  const int wanted_height = std::max(wanted_end - wanted_first, config_.least_height_px);
  const bool too_large = end_row_px_ - first_row_px_ > static_cast<int>(k_worth_ratio * wanted_height);
  profiles_too_large_ = too_large ? profiles_too_large_ + 1 : 0;
  // Found again after a search: at once, since the whole height is slow.
  if (too_large && (searching_ || profiles_too_large_ >= config_.profiles_to_shrink))
    return rt_propose(wanted_first, wanted_end, false);
  return rt_propose(first_row_px_, end_row_px_, false);
}

}  // namespace biteline::pipeline
