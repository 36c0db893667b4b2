// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a way turns off a crease that goes straight on without it.

#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/level/patch.hpp"
#include "host/bite_line/level/step_costs.hpp"

namespace biteline::bite_line {

struct BranchConfig {
  double lever_mm{6};            ///< over which the way's direction is read, before a place and behind it
  double least_turn_rad{0.4};    ///< of the way, to turn off
  double from_mm{4}, to_mm{20};  ///< where the crease is looked for, straight on
  double beside_mm{1};           ///< it may lie so far beside that, and 0.1 of how far on
  double least_share{0.8};       ///< of that length that shows it
  float plain_cost{0.15F};       ///< of a step on it, at most, per millimetre
  double apart_mm{2.5};          ///< what is nearer to the way is the way's own
};

/// Indices of a way's places.
struct Branches {
  std::vector<std::size_t> onto;  ///< a crease that comes straight from behind
  std::vector<std::size_t> off;   ///< one that goes straight on

  /// Whether the way keeps to a crease that goes on beyond it at both ends.
  [[nodiscard]] bool lie_on_another() const {
    return !onto.empty() && !off.empty() && onto.front() < off.back();
  }
};

/// Where a way over places (s, z) turns onto a plain crease, and off it.  Creases of a shoe lie one over the
/// other and do not branch: there the way changes from one to another.  `bare_costs` as doubt_way() has them.
[[nodiscard]] Branches branches(const Patch& patch, const StepCosts& bare_costs, std::span<const Vec2> way,
                                const BranchConfig& config);

}  // namespace biteline::bite_line
