// SPDX-License-Identifier: MIT
#include "firmware/app/capture.hpp"

#include <algorithm>

namespace biteline::sensor {
namespace {

/// Of a frame's period: the rest is for the read-out to begin.
constexpr double k_exposure_share = 0.9;

Nanoseconds longest_within_period(const geometry::SensorModel& head) {
  return Nanoseconds{static_cast<std::int64_t>(k_exposure_share * 1e9 / *head.rate_hz)};
}

pipeline::ExposureControl::Config exposure_limits(const geometry::SensorModel& head,
                                                  const hal::CameraLimits& limits) {
  pipeline::ExposureControl::Config config;
  config.minimum = std::max(config.minimum, limits.exposure_min);
  config.maximum = std::min({config.maximum, limits.exposure_max, longest_within_period(head)});
  return config;
}

pipeline::RegionFollower::Config region_limits(const geometry::Region& region,
                                               const hal::CameraLimits& limits) {
  pipeline::RegionFollower::Config config;
  config.first_row_px = region.offset_v_px;
  config.end_row_px = region.offset_v_px + region.height_px;
  config.step_px = std::max(config.step_px, limits.region_step_v_px);
  config.least_height_px = std::min(config.least_height_px, region.height_px);
  return config;
}

}  // namespace

Result<void> check(const Capture& capture, const geometry::SensorModel& head) {
  if (capture.second_exposure.count() != 0 && capture.laser_off_frames) {
    return fail(Errc::InvalidArgument,
                "a second exposure and laser-off frames exclude each other: the ambient light "
                "of one exposure is not that of the other");
  }
  if (capture.test_pattern && capture.any()) {
    return fail(Errc::InvalidArgument,
                "camera.test_pattern goes with neither automatic exposure, following, laser-off frames nor a "
                "second exposure, in the settings or on the command line");
  }
  if (capture.pairs() && capture.auto_exposure) {
    return fail(Errc::InvalidArgument,
                "automatic exposure goes with neither a second exposure nor laser-off frames: "
                "the camera's two sets of settings stand while it runs");
  }
  if (capture.second_exposure.count() != 0 && capture.second_exposure <= *head.exposure) {
    return fail(Errc::InvalidArgument, "second exposure of %lld ns: longer than the head's %lld ns expected",
                static_cast<long long>(capture.second_exposure.count()),
                static_cast<long long>(head.exposure->count()));
  }
  if (capture.second_exposure > longest_within_period(head)) {
    return fail(Errc::InvalidArgument, "second exposure of %lld ns: at %g frames a second %lld ns at most",
                static_cast<long long>(capture.second_exposure.count()), *head.rate_hz,
                static_cast<long long>(longest_within_period(head).count()));
  }
  return {};
}

Nanoseconds longest_exposure(const Capture& capture, const geometry::SensorModel& head) {
  if (capture.auto_exposure)
    return std::max(*head.exposure, exposure_limits(head, {.exposure_max = Nanoseconds::max()}).maximum);
  return std::max(*head.exposure, capture.second_exposure);
}

Result<std::unique_ptr<CaptureControl>> CaptureControl::create(const Capture& capture,
                                                               const geometry::SensorModel& head,
                                                               hal::LineCamera& camera) {
  hal::CameraLimits limits;
  if (capture.auto_exposure || capture.follow_stripe) {
    BITELINE_ASSIGN(limits, camera.limits());
  }
  if (capture.follow_stripe && !limits.rows_adjustable)
    return fail(Errc::NotSupported,
                "the stripe cannot be followed: this camera's region stands while it runs");
  return std::unique_ptr<CaptureControl>{new CaptureControl{capture, head, limits}};
}

CaptureControl::CaptureControl(const Capture& capture, const geometry::SensorModel& head,
                               const hal::CameraLimits& limits)
    : capture_{capture},
      region_{head.region},
      exposure_control_{exposure_limits(head, limits), head.exposure.value_or(Nanoseconds{0})},
      region_follower_{region_limits(head.region, limits)},
      state_{.exposure = head.exposure.value_or(Nanoseconds{0}), .rows_px = head.region.height_px} {
  published_.rt_store(state_);
}

CaptureControl::Wish CaptureControl::rt_consider(const profile::ProfileBuffer& profile) noexcept BITELINE_RT {
  Wish wish;
  if (capture_.auto_exposure) {
    const auto decision = exposure_control_.rt_update(profile, region_.width_px);
    if (decision.changed) wish.exposure = decision.exposure;
  }
  if (capture_.follow_stripe) {
    const auto proposal = region_follower_.rt_update(profile);
    state_.rate_max_hz = proposal.rate_max_hz;
    state_.searching = proposal.searching;
    published_.rt_store(state_);
    if (proposal.changed) wish.rows = proposal;
  }
  return wish;
}

Result<void> CaptureControl::apply(const Wish& wish, hal::LineCamera& camera) {
  if (wish.exposure) {
    BITELINE_ASSIGN(state_.exposure, camera.adjust_exposure(*wish.exposure));
    ++state_.exposure_changes;
  }
  if (wish.rows) {
    BITELINE_ASSIGN(const hal::RowRange rows,
                    camera.adjust_rows({.first_px = wish.rows->offset_v_px - region_.offset_v_px,
                                        .height_px = wish.rows->height_px}));
    state_.first_row_px = rows.first_px;
    state_.rows_px = rows.height_px;
    ++state_.row_changes;
  }
  if (wish.exposure || wish.rows) published_.rt_store(state_);
  return {};
}

}  // namespace biteline::sensor
