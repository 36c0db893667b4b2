// SPDX-License-Identifier: MIT
#pragma once
/// \file What an arm's encoders do not see of its give, where no surface in view shows it.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/geometry/se3.hpp"

namespace biteline::uncertainty {

/// Where the figure comes from: the first that there is counts.
enum class ArmSource : std::uint8_t {
  Table,         ///< a level surface beside the shoe, in this scan
  Stated,        ///< uncertainty.yaml
  EarlierScans,  ///< of this cell, which showed such a surface
  Assumed,
};
/// For report.json.
[[nodiscard]] std::string_view to_string(ArmSource source);

/// What gives bends as a spring does: by force, so by acceleration.  One figure holds for all speeds and ways
/// of an arm with its head: standard deviation of one coordinate over the root mean square acceleration of
/// the stripe's middle.
struct ArmGive {
  double mm_per_m_s2{0};
  ArmSource source{ArmSource::Assumed};
};

/// A soft arm, 8 Hz, whose encoders see nothing of its give.  Too much for most: a small figure that is false
/// is worse.
inline constexpr ArmGive k_assumed_give{.mm_per_m_s2 = 0.12, .source = ArmSource::Assumed};

/// A profile's middle, carried by the flange.
struct CarriedPoint {
  SE3 T_base_flange{SE3::Identity()};
  double time_s{0};
  Vec3 point_base{Vec3::Zero()};
};

/// Squared acceleration of each as told, (m/s^2)^2: of a cubic over a twentieth of a second to either side,
/// five points at least.  Empty where there are fewer, or time does not rise.
[[nodiscard]] std::vector<double> squared_accelerations(std::span<const CarriedPoint> points);

}  // namespace biteline::uncertainty
