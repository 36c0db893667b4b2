// SPDX-License-Identifier: MIT
#pragma once
/// \file Profiles of random numbers for tests of what carries them.

#include <random>

#include "common/profile/profile.hpp"

namespace biteline::test {

inline profile::Profile made_profile(std::uint64_t sequence, std::size_t points) {
  std::mt19937 random{static_cast<std::mt19937::result_type>(sequence + 1)};
  std::uniform_real_distribution<float> number{-500, 500};
  profile::Profile profile;
  profile.header.sequence = sequence;
  profile.header.frame_sequence = sequence + 7;
  profile.header.exposure_mid =
      SensorClock::time_point{Nanoseconds{1'700'000'000'000'000'000 + static_cast<std::int64_t>(sequence)}};
  profile.header.T_base_flange =
      geometry::make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{0.1 * static_cast<double>(sequence % 30),
                                                              Vec3{1, 2, 3}.normalized()}},
                         {1, 2, 3});
  profile.header.pose_age = Nanoseconds{12345};
  profile.header.flags = profile::k_profile_overrun;
  if (sequence % 2 == 0)
    profile.header.encoder_ticks = -0x1'2345'6789'abcd - static_cast<std::int64_t>(sequence);
  if (sequence % 3 == 0) profile.header.speckle_contrast = 0.47F + 0.001F * static_cast<float>(sequence);
  for (std::size_t i = 0; i < points; ++i) {
    profile::ProfilePoint point;
    point.point_cam = {number(random), number(random), number(random)};
    point.sigma_mm = number(random);
    point.row_px = number(random);
    point.sigma_row_px = number(random);
    point.amplitude = number(random);
    point.width_px = number(random);
    point.column = static_cast<std::uint16_t>(2 * i);
    point.flags = static_cast<std::uint16_t>(random() & 0x1FF);
    point.peak_count = static_cast<std::uint8_t>(random() & 0xFF);
    profile.points.push_back(point);
  }
  return profile;
}

}  // namespace biteline::test
