// SPDX-License-Identifier: MIT
#pragma once
/// \file How far a place of a scan may be off by calibration, poses and clock: what its points do not tell.

#include <span>
#include <vector>

#include "host/cloud/uncertainty/head_uncertainty.hpp"

namespace biteline::uncertainty {

/// Where the arm was when a profile was taken.
struct ProfilePose {
  SE3 T_base_flange{SE3::Identity()};
  double time_s{0};  ///< of the exposure, from any beginning
};

/// A head as it was used, and how well it is known.
struct KnownHead {
  geometry::SensorModel model;
  HeadUncertainty uncertainty;
};

/// First order: a place moves as the head's parameters, its profile's pose and the clock move it.
/// Thread: const, any.
class ScanSpread {
 public:
  /// `poses` in the order of time, without doubles; borrowed for the constructor only.
  ScanSpread(const KnownHead& head, std::span<const ProfilePose> poses);

  /// Covariance of the place in base, mm^2: of a place on the scanned surface, by the profile whose laser
  /// plane lies nearest among those that have it in view.  Zero where there is none.  Cost: 40
  /// triangulations.  `arm_sigma_mm`: poses are off by no less in each coordinate, as the scan itself shows.
  [[nodiscard]] Mat3 covariance_mm2(const Vec3& point_base, double arm_sigma_mm = 0) const;

 private:
  struct Eye {
    SE3 T_base_cam;
    Vec3 plane_normal_base;
    double plane_distance_mm;
  };
  [[nodiscard]] std::ptrdiff_t nearest_profile(const Vec3& point_base) const;
  [[nodiscard]] Vec3 velocity_mm_s(std::size_t profile, const Vec3& point_flange) const;

  KnownHead head_;
  std::vector<ProfilePose> poses_;
  std::vector<Eye> eyes_;
};

}  // namespace biteline::uncertainty
