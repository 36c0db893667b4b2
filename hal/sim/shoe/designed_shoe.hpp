// SPDX-License-Identifier: MIT
#pragma once
/// \file Shoes whose soles are built as soles are built, with what else runs round them; and no shoes.

#include <cstdint>
#include <optional>

#include "hal/sim/shoe/shoe_parameters.hpp"

namespace biteline::sim {

/// One cell of the sweep: how it is built, what else is on it, what it looks like.
struct DesignedShoe {
  ShoeClass shoe_class{ShoeClass::Cupsole};
  Decoy decoy{Decoy::None};
  Materials materials{Materials::Contrast};
  bool painted{false};                 ///< ledges, tapes and pieces laid on have colours of their own
  std::optional<double> length_mm{};   ///< else drawn
  std::optional<double> heel_ratio{};  ///< height of the heel over the length; else drawn
  bool toe_guard{false};  ///< the sole wraps up over the toe, by 6 to 22 mm and up to 80 degrees steep
};

/// Sole 90 to 350 mm long, low, mid-high or a boot, left or right.  A decoy keeps 4 mm and more away from the
/// line, so that the line's place stays what its definition says; where a sole is too thin for it, it is left
/// out.  One shoe in four carries a second one.  Pre: a designed class.
[[nodiscard]] ShoeParameters draw_designed_shoe(const DesignedShoe& designed, std::uint64_t seed);

/// A thing that is no shoe, with a crease all round all the same.  Pre: such a class.
[[nodiscard]] ShoeParameters draw_thing(ShoeClass shoe_class, std::uint64_t seed);

}  // namespace biteline::sim
