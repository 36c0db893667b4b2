// SPDX-License-Identifier: MIT
#pragma once
/// \file A finished scan as the calibration's watch looks at it.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "host/cloud/uncertainty/scan_spread.hpp"

namespace biteline::drift {

/// Where the arm was when a profile was taken.
struct PosedProfile {
  std::uint32_t profile{0};  ///< its sequence number
  uncertainty::ProfilePose pose{};
};

/// Borrowed.
struct ScanView {
  std::span<const Eigen::Vector3f> points_base;  ///< in scan order
  std::span<const std::uint32_t> profile;        ///< of each point
  std::span<const PosedProfile> poses;           ///< in the order of their numbers
};

/// Place in `poses` of each point's profile.  None: it has no pose, is no place, or the arm stood still.
inline constexpr std::uint32_t k_no_frame = std::numeric_limits<std::uint32_t>::max();
[[nodiscard]] std::vector<std::uint32_t> frames_of(const ScanView& scan);

/// Of the flange's frame at a point, from the neighbouring poses.
[[nodiscard]] Vec3 velocity_mm_s(std::span<const PosedProfile> poses, std::size_t frame,
                                 const Vec3& point_base);

}  // namespace biteline::drift
