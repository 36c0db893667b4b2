// SPDX-License-Identifier: MIT
#pragma once
/// \file A pose as a controller's message tells it, before anybody has judged its instant.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "common/geometry/se3.hpp"
#include "common/time/clocks.hpp"

namespace biteline::hal {

struct ToldPose {
  RobotClock::time_point stamp;           ///< the controller's own
  std::optional<std::uint32_t> number{};  ///< counts messages, where the language has such a count
  SE3 T_base_flange{SE3::Identity()};
  std::uint32_t status{0};  ///< PoseStatus
};

/// Whether an arm can be there.  \param place_mm of the flange in base.
[[nodiscard]] inline bool within_reach(const Vec3& place_mm) {
  constexpr double k_reach_max_mm = 100'000;  // no arm; what is beyond is no pose
  return std::all_of(place_mm.begin(), place_mm.end(), [](double part_mm) {
    return std::isfinite(part_mm) && std::abs(part_mm) < k_reach_max_mm;
  });
}

}  // namespace biteline::hal
