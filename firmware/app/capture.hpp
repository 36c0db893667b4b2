// SPDX-License-Identifier: MIT
#pragma once
/// \file How frames are exposed beyond the head's own settings, and who changes that while a scan runs.

#include <memory>
#include <optional>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/rt/latest_value.hpp"
#include "common/wire/messages.hpp"
#include "firmware/pipeline/exposure_control.hpp"
#include "firmware/pipeline/region_follower.hpp"
#include "hal/api/line_camera.hpp"

namespace biteline::sensor {

/// What a user may ask for; nothing by default.
struct Capture {
  bool auto_exposure{false};       ///< follows the share of valid and of saturated columns
  bool follow_stripe{false};       ///< the camera shows only the rows about the stripe
  bool laser_off_frames{false};    ///< every second frame without laser, taken off the next
  Nanoseconds second_exposure{0};  ///< every second frame this long, merged per column; 0: none
  bool test_pattern{false};        ///< made pictures, and no light

  [[nodiscard]] bool any() const {
    return auto_exposure || follow_stripe || laser_off_frames || second_exposure.count() != 0;
  }
  /// Two frames make one profile.
  [[nodiscard]] bool pairs() const { return laser_off_frames || second_exposure.count() != 0; }
};

/// Errc::InvalidArgument for what excludes each other or does not fit the head.
[[nodiscard]] Result<void> check(const Capture& capture, const geometry::SensorModel& head);

/// The longest exposure that may occur: the light has to last that long.
[[nodiscard]] Nanoseconds longest_exposure(const Capture& capture, const geometry::SensorModel& head);

/// Sets exposure and rows after each profile.
///
/// In two steps, since a profile is no longer this thread's once it is in the ring:
///
///     const auto wish = control.rt_consider(profile);
///     ring.rt_push(...);
///     control.apply(wish, camera);   // a round trip to the camera, now and then
///
/// Thread: acquisition; state() from any.
class CaptureControl {
 public:
  /// Errc::NotSupported when the camera cannot.
  [[nodiscard]] static Result<std::unique_ptr<CaptureControl>> create(const Capture& capture,
                                                                      const geometry::SensorModel& head,
                                                                      hal::LineCamera& camera);

  struct Wish {
    std::optional<Nanoseconds> exposure;
    std::optional<pipeline::RegionFollower::Proposal> rows;
  };
  [[nodiscard]] Wish rt_consider(const profile::ProfileBuffer& profile) noexcept BITELINE_RT;

  [[nodiscard]] Result<void> apply(const Wish& wish, hal::LineCamera& camera);

  /// What the camera is set to now.
  [[nodiscard]] wire::CaptureState state() const {
    return published_.rt_load().value_or(wire::CaptureState{});
  }

 private:
  CaptureControl(const Capture& capture, const geometry::SensorModel& head, const hal::CameraLimits& limits);

  Capture capture_;
  geometry::Region region_;
  pipeline::ExposureControl exposure_control_;
  pipeline::RegionFollower region_follower_;
  wire::CaptureState state_;
  rt::LatestValue<wire::CaptureState> published_;
};

}  // namespace biteline::sensor
