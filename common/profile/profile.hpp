// SPDX-License-Identifier: MIT
#pragma once
/// \file A profile: the 3-D points of one laser stripe, at most one per image column and kept peak.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/time/clocks.hpp"

namespace biteline::profile {

/// What is known about one point beyond its place.  0: an ordinary good point.
enum PointFlag : std::uint16_t {
  k_point_saturated = 1U << 0U,      ///< some pixels of the stripe at full scale
  k_point_clipped = 1U << 1U,        ///< the stripe touches the region's edge
  k_point_wide = 1U << 2U,           ///< wider than the stripe's plausible width
  k_point_narrow = 1U << 3U,         ///< narrower
  k_point_other_peaks = 1U << 4U,    ///< the column holds further peaks
  k_point_reflection = 1U << 5U,     ///< taken for a mirror image: kept as evidence, not part of the surface
  k_point_discontinuous = 1U << 6U,  ///< far from both neighbours
  k_point_second_exposure = 1U << 7U,  ///< from the longer exposure of a bracket
  k_point_edge_mixed = 1U << 8U,       ///< stripe broken here: the peak mixes two surfaces
  k_point_brightness_step =
      1U << 9U,  ///< stripe cut on one side by print or another step of brightness: its place is shifted
};

/// Points with one of these are evidence, not surface: they stay out of the cloud.
inline constexpr std::uint16_t k_point_not_surface =
    k_point_clipped | k_point_reflection | k_point_edge_mixed | k_point_brightness_step;

/// What is known about the whole profile.  0: an ordinary good profile.
enum ProfileFlag : std::uint32_t {
  k_profile_pose_missing = 1U << 0U,       ///< no pose: points are in cam only, never part of a cloud
  k_profile_pose_stale = 1U << 1U,         ///< nearest pose farther from the exposure than allowed
  k_profile_pose_extrapolated = 1U << 2U,  ///< no pose on one side of the exposure
  k_profile_frame_gap = 1U << 3U,          ///< frames were lost just before this one
  k_profile_overrun = 1U << 4U,            ///< processed late
  k_profile_trigger_mismatch = 1U << 5U,   ///< exposure and trigger edge do not pair
  k_profile_stripe_lost = 1U << 6U,        ///< hardly any column shows the stripe
  k_profile_clock_unsure = 1U << 7U,       ///< clock mapping not (any more) good enough
  k_profile_frame_damaged = 1U << 8U,      ///< the driver marked the frame as bad
};

/// Profiles with one of these never enter a cloud.
inline constexpr std::uint32_t k_profile_not_usable = k_profile_pose_missing | k_profile_pose_stale |
                                                      k_profile_trigger_mismatch | k_profile_clock_unsure |
                                                      k_profile_frame_damaged;

struct ProfilePoint {
  Eigen::Vector3f point_cam{Eigen::Vector3f::Zero()};  ///< mm
  float sigma_mm{
      0};  ///< standard deviation of its place, along the way it moves in the laser plane when its row errs
  float row_px{0};          ///< sub-pixel row in the full sensor
  float sigma_row_px{0};    ///< its standard deviation
  float amplitude{0};       ///< stripe height above background, grey levels
  float width_px{0};        ///< full width at half maximum
  std::uint16_t column{0};  ///< column in the region
  std::uint16_t flags{0};   ///< PointFlag
  std::uint8_t peak_count{0};
};

struct ProfileHeader {
  std::uint64_t sequence{0};             ///< counts profiles from 0, gaps are losses
  std::uint64_t frame_sequence{0};       ///< the camera's own count
  SensorClock::time_point exposure_mid;  ///< middle of the exposure
  SE3 T_base_flange{SE3::Identity()};    ///< at exposure_mid
  Nanoseconds second_exposure_after{
      0};                   ///< of a bracket: from exposure_mid to the longer exposure's middle; 0: none
  Nanoseconds pose_age{0};  ///< distance in time from exposure_mid to the nearest pose sample
  std::uint32_t flags{0};   ///< ProfileFlag
  /// An encoder's count at exposure_mid, where one is the pose (geometry::PoseEstimate).
  std::optional<std::int64_t> encoder_ticks{};
  /// The laser's speckle as the stripe shows it: standard deviation over mean of one pixel on its crest, the
  /// camera's noise taken off.  Of a bracket: the longer exposure's, where it is known.  Nothing where too
  /// few columns show it.
  std::optional<float> speckle_contrast{};
};

/// A profile on the host: as long as it has points.
struct Profile {
  ProfileHeader header;
  std::vector<ProfilePoint> points;  ///< by column, then row
};

/// Two kept peaks in each of 2592 columns, the widest of the usual 5-megapixel sensors.
inline constexpr std::size_t k_max_profile_points = 5184;

/// A profile in the firmware: fixed capacity, lives in a ring, never on the heap after start-up.
struct ProfileBuffer {
  ProfileHeader header;
  std::size_t count{0};
  std::array<ProfilePoint, k_max_profile_points> points;

  [[nodiscard]] std::span<const ProfilePoint> view() const { return {points.data(), count}; }
};

}  // namespace biteline::profile
