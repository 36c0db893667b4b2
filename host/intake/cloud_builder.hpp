// SPDX-License-Identifier: MIT
#pragma once
/// \file Profiles to one cloud in base, and an account of what was left out.

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/sensor_model.hpp"
#include "common/profile/profile.hpp"
#include "host/cloud/curvature/scan_surface.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::intake {

/// What came, what stayed out and why.  A profile or point with several flags counts under each of them.
struct IngestCounts {
  std::uint64_t profiles{0};  ///< received
  std::uint64_t profiles_used{0};
  std::uint64_t profiles_lost{0};  ///< gaps in their numbers, wherever they were lost
  std::uint64_t points{0};         ///< received, also those of profiles left out
  std::uint64_t points_used{0};
  std::uint64_t points_not_surface{0};  ///< evidence only, in profiles that were used
  std::uint64_t points_of_unusable_profiles{0};
  double duration_s{0};      ///< from the first profile's exposure to the last one's, by the sensor's clock
  std::uint64_t columns{0};  ///< of all profiles
  std::uint64_t columns_with_stripe{0};     ///< of these: with a point
  std::uint64_t profiles_along_columns{0};  ///< whose points lie along the columns rather than across them
  double pose_age_max_s{0};                 ///< from a stale profile's exposure to its nearest pose
  std::vector<float> speckle_contrasts{};   ///< of the profiles that were used and tell it
  std::array<std::uint64_t, 32> profiles_by_flag{};  ///< index: bit of ProfileFlag
  std::array<std::uint64_t, 16> points_by_flag{};    ///< index: bit of PointFlag
};

/// The flags' names with their counts, those that occur only: for report.json.
[[nodiscard]] std::vector<std::pair<std::string, std::uint64_t>> profile_flag_counts(
    const IngestCounts& counts);
[[nodiscard]] std::vector<std::pair<std::string, std::uint64_t>> point_flag_counts(
    const IngestCounts& counts);

/// All of that but what only the numbers of the profiles and the points' places tell.  `columns`: of the
/// region.
void count_profile(const profile::Profile& profile, int columns, IngestCounts& counts);

/// A profile as it came, its points in the cloud, and the stripe at these.
using OnProfile = std::function<void(const profile::Profile&, std::span<const Eigen::Vector3f> points_base,
                                     const cloud::StripeSpan& stripe)>;

/// Leaves out profiles with k_profile_not_usable and points with k_point_not_surface; normals and curvature
/// are worked out as profiles come.  Not thread-safe.
class CloudBuilder {
 public:
  explicit CloudBuilder(const geometry::SensorModel& sensor)
      : T_flange_cam_{sensor.T_flange_cam}, columns_{sensor.region.width_px} {}

  /// The points that came in, in base; valid until the next call.
  std::span<const Eigen::Vector3f> add(const profile::Profile& profile);
  /// At those points.
  [[nodiscard]] cloud::StripeSpan stripe_of_last() const {
    return cloud_.stripe(first_of_last_, cloud_.size() - first_of_last_);
  }

  [[nodiscard]] const IngestCounts& counts() const { return counts_; }
  /// As far as it came; without normals and curvature.
  [[nodiscard]] const cloud::PointCloud& cloud() const { return cloud_; }
  /// The finished cloud; no profile may come after it.
  [[nodiscard]] cloud::PointCloud take();

 private:
  void append(const SE3& T_base_cam, std::uint64_t sequence, const profile::ProfilePoint& point);

  SE3 T_flange_cam_;
  int columns_;  ///< of the region
  cloud::PointCloud cloud_;
  curvature::ScanSurface surface_;
  IngestCounts counts_;
  std::size_t first_of_last_{0};  ///< in the cloud, of the last profile
  std::uint64_t next_sequence_{0};
  double begun_s_{0};  ///< exposure of the first profile
};

}  // namespace biteline::intake
