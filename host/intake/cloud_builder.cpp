// SPDX-License-Identifier: MIT
#include "host/intake/cloud_builder.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/core/numbers.hpp"

namespace biteline::intake {
namespace {

struct FlagName {
  std::uint32_t flag;
  const char* name;
};

constexpr std::array k_profile_flags{FlagName{profile::k_profile_pose_missing, "pose_missing"},
                                     FlagName{profile::k_profile_pose_stale, "pose_stale"},
                                     FlagName{profile::k_profile_pose_extrapolated, "pose_extrapolated"},
                                     FlagName{profile::k_profile_frame_gap, "frame_gap"},
                                     FlagName{profile::k_profile_overrun, "overrun"},
                                     FlagName{profile::k_profile_trigger_mismatch, "trigger_mismatch"},
                                     FlagName{profile::k_profile_stripe_lost, "stripe_lost"},
                                     FlagName{profile::k_profile_clock_unsure, "clock_unsure"},
                                     FlagName{profile::k_profile_frame_damaged, "frame_damaged"}};

constexpr std::array k_point_flags{FlagName{profile::k_point_saturated, "saturated"},
                                   FlagName{profile::k_point_clipped, "clipped"},
                                   FlagName{profile::k_point_wide, "wide"},
                                   FlagName{profile::k_point_narrow, "narrow"},
                                   FlagName{profile::k_point_other_peaks, "other_peaks"},
                                   FlagName{profile::k_point_reflection, "reflection"},
                                   FlagName{profile::k_point_discontinuous, "discontinuous"},
                                   FlagName{profile::k_point_second_exposure, "second_exposure"},
                                   FlagName{profile::k_point_edge_mixed, "edge_mixed"},
                                   FlagName{profile::k_point_brightness_step, "brightness_step"}};

template <std::size_t Bits>
void count_flags(std::uint32_t flags, std::array<std::uint64_t, Bits>& counts) {
  for (; flags != 0; flags &= flags - 1) ++counts[static_cast<std::size_t>(__builtin_ctz(flags))];
}

template <std::size_t Names, std::size_t Bits>
std::vector<std::pair<std::string, std::uint64_t>> named(const std::array<FlagName, Names>& names,
                                                         const std::array<std::uint64_t, Bits>& counts) {
  std::vector<std::pair<std::string, std::uint64_t>> result;
  for (std::size_t bit = 0; bit < Bits; ++bit) {
    if (counts[bit] == 0) continue;
    std::string name = "bit_" + std::to_string(bit);  // of a newer sensor
    for (const FlagName& known : names) {
      if (known.flag == (std::uint32_t{1} << bit)) name = known.name;
    }
    result.emplace_back(std::move(name), counts[bit]);
  }
  return result;
}

/// What no stripe measures is not known: a sensor's numbers come from outside.
float known_or_none(float value) {
  return std::isfinite(value) && value > 0 ? value : 0.F;
}

/// The spread of the points each way: a stripe across the columns is as wide as the picture and far less
/// high.
void count_stripe(std::span<const profile::ProfilePoint> points, IngestCounts& counts) {
  double n = 0, u = 0, uu = 0, v = 0, vv = 0;
  int last = -1;
  for (const profile::ProfilePoint& point : points) {
    if (point.column == last || !std::isfinite(point.row_px)) continue;
    last = point.column;
    n += 1;
    u += point.column;
    uu += static_cast<double>(point.column) * point.column;
    v += point.row_px;
    vv += static_cast<double>(point.row_px) * point.row_px;
  }
  counts.columns_with_stripe += static_cast<std::uint64_t>(n);
  if (n > 1 && vv - v * v / n > uu - u * u / n) ++counts.profiles_along_columns;
}

void count_used(const profile::ProfileHeader& header, IngestCounts& counts) {
  ++counts.profiles_used;
  if (header.speckle_contrast) counts.speckle_contrasts.push_back(*header.speckle_contrast);
}

}  // namespace

std::vector<std::pair<std::string, std::uint64_t>> profile_flag_counts(const IngestCounts& counts) {
  return named(k_profile_flags, counts.profiles_by_flag);
}

std::vector<std::pair<std::string, std::uint64_t>> point_flag_counts(const IngestCounts& counts) {
  return named(k_point_flags, counts.points_by_flag);
}

void count_profile(const profile::Profile& profile, int columns, IngestCounts& counts) {
  const profile::ProfileHeader& header = profile.header;
  ++counts.profiles;
  counts.points += profile.points.size();
  count_flags(header.flags, counts.profiles_by_flag);
  for (const profile::ProfilePoint& point : profile.points) count_flags(point.flags, counts.points_by_flag);
  if ((header.flags & profile::k_profile_not_usable) != 0)
    counts.points_of_unusable_profiles += profile.points.size();
  else
    count_used(header, counts);
  if ((header.flags & profile::k_profile_pose_stale) != 0)
    counts.pose_age_max_s =
        std::max(counts.pose_age_max_s, 1e-9 * std::abs(static_cast<double>(header.pose_age.count())));
  counts.columns += static_cast<std::uint64_t>(std::max(0, columns));
  count_stripe(profile.points, counts);
}

std::span<const Eigen::Vector3f> CloudBuilder::add(const profile::Profile& profile) {
  const profile::ProfileHeader& header = profile.header;
  // As numbers with a point: a stamp from outside may be anything.
  const double exposed_s = 1e-9 * static_cast<double>(header.exposure_mid.time_since_epoch().count());
  if (counts_.profiles == 0) begun_s_ = exposed_s;
  counts_.duration_s = exposed_s - begun_s_;
  if (header.sequence > next_sequence_) counts_.profiles_lost += header.sequence - next_sequence_;
  next_sequence_ = header.sequence + 1;
  first_of_last_ = cloud_.size();
  count_profile(profile, columns_, counts_);

  if ((header.flags & profile::k_profile_not_usable) != 0) return {};
  const SE3 T_base_cam = header.T_base_flange * T_flange_cam_;
  for (const profile::ProfilePoint& point : profile.points) {
    if ((point.flags & profile::k_point_not_surface) != 0) {
      ++counts_.points_not_surface;
    } else {
      append(T_base_cam, header.sequence, point);
    }
  }
  const std::span points = std::span{cloud_.points}.subspan(first_of_last_);
  surface_.add_profile(points, std::span{cloud_.column}.subspan(first_of_last_),
                       T_base_cam.translation().cast<float>());
  return points;
}

cloud::PointCloud CloudBuilder::take() {
  surface_.finish();
  cloud_.normals = surface_.take_normals();
  cloud_.mean_per_mm = surface_.take_mean_per_mm();
  return std::move(cloud_);
}

void CloudBuilder::append(const SE3& T_base_cam, std::uint64_t sequence, const profile::ProfilePoint& point) {
  const Vec3 place_base = T_base_cam * point.point_cam.cast<double>();
  if (!is_plausible_place(place_base)) {
    // A ray nearly along the laser plane meets it far away; no surface is there.
    ++counts_.points_not_surface;
    return;
  }
  ++counts_.points_used;
  cloud_.points.emplace_back(place_base.cast<float>());
  cloud_.profile.push_back(static_cast<std::uint32_t>(sequence));
  cloud_.column.push_back(point.column);
  cloud_.sigma_mm.push_back(point.sigma_mm);
  cloud_.flags.push_back(point.flags);
  cloud_.amplitude.push_back(known_or_none(point.amplitude));
  cloud_.width_px.push_back(known_or_none(point.width_px));
}

}  // namespace biteline::intake
