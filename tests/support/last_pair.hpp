// SPDX-License-Identifier: MIT
#pragma once
/// \file Pairs of a sample and the next upper of its model as clouds, without pictures: lasts that differ
/// smoothly round the shoe and with height, collars that are the same edge, cut elsewhere or out of view.

#include <array>
#include <cstdint>
#include <string_view>

#include "hal/sim/shoe/shoe_parameters.hpp"
#include "tests/support/made_pair.hpp"

namespace biteline::test {

/// What of the collar the two scans have in common.
enum class Collar : std::uint8_t {
  Same,       ///< one edge, in view in both
  Trimmed,    ///< one edge, cut by hand: it wavers by 0.03 to 0.15 mm
  Elsewhere,  ///< the upper's is cut 0.5 to 6 mm higher or lower, aslant and wavy
  Parallel,   ///< the upper's is cut higher or lower by the same all the way round
  UpperCut,   ///< out of the upper's view
  BothCut,    ///< out of view in both, at heights of their own
};
inline constexpr std::array<std::string_view, 6> k_collar_names{"same",     "trimmed",   "elsewhere",
                                                                "parallel", "upper cut", "both cut"};

/// How the difference of two lasts varies.
enum class Waves : std::uint8_t {
  AnyWay,  ///< on the unrolled wall, in any direction
  Space,   ///< in space, in any direction
  Beside,  ///< round the shoe and with height, each its own length
  Round,   ///< round the shoe only
};
inline constexpr std::array<std::string_view, 4> k_waves_names{"any way", "space", "beside", "round"};

struct LastPairSettings {
  sim::ShoeClass shoe_class{sim::ShoeClass::Deep};
  std::uint64_t seed{1};
  double difference_rms_mm{0.15};
  Waves waves{Waves::AnyWay};
  Collar collar{Collar::Same};
  bool feather_seen{true};  ///< the upper's scan goes down to its lower end, not only below the line
};

/// Truth: the sample's line at the same place of the outline and the same height, on the upper's surface.
[[nodiscard]] MadePair last_pair(const LastPairSettings& settings);

}  // namespace biteline::test
