// SPDX-License-Identifier: MIT
#pragma once
/// \file A made shoe before an arm that can scan it all round, for benches of what comes after the scan.

#include <array>
#include <cstdint>
#include <memory>

#include "hal/sim/live/reachable_scan.hpp"
#include "hal/sim/record/surroundings.hpp"
#include "host/robot/kinematics/arm_model.hpp"

namespace biteline::bench {

struct ShoeInReach {
  std::unique_ptr<sim::MadeScene> scene;
  kinematics::Joints from_rad;  ///< where the arm stands after the scan
};

/// One of six classes, of size 38 to 45, by its seed.  `arm_name`: of `arm`, as in "ur10e".
inline Result<ShoeInReach> shoe_in_reach(std::uint64_t seed, const sim::ArmKinematics& arm,
                                         const char* arm_name) {
  constexpr std::array k_classes{sim::ShoeClass::Deep, sim::ShoeClass::Cupsole, sim::ShoeClass::Midsole,
                                 sim::ShoeClass::Boot, sim::ShoeClass::Welted,  sim::ShoeClass::Vulcanised};
  const int size = 38 + static_cast<int>(seed % 8);
  ShoeInReach shoe;
  BITELINE_ASSIGN(
      shoe.scene,
      sim::make_scene(
          {.shoe = sim::draw_shoe(k_classes[seed % k_classes.size()], seed, sim::length_of_size_mm(size)),
           .place_seed = seed,
           .places = sim::places_within_reach_of(arm_name),
           .holder = sim::Holder::Bracket,
           .scan_speed_mm_s = 400,
           .scan_begin_ratio = 0.25,
           .scan_clockwise = true,
           .fineness = {.column_mm = 2, .fine_row_mm = 1, .fine_band_mm = 4, .coarse_row_mm = 2}}));
  BITELINE_ASSIGN(const sim::ReachableScan reachable, sim::place_within_reach(*shoe.scene, arm, arm_name));
  shoe.from_rad = reachable.scan->q_rad_at(reachable.scan->duration_s());
  return shoe;
}

}  // namespace biteline::bench
