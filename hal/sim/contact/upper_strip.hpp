// SPDX-License-Identifier: MIT
#pragma once
/// \file The strip of a made shoe's upper that a tool presses on: small elastic pieces over a hard last.

#include <cstdint>
#include <span>
#include <vector>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/true_line.hpp"

namespace biteline::sim {

/// One piece; it gives along its own normal, as of an elastic foundation (Winkler).
struct UpperPiece {
  Vec3 point_base{Vec3::Zero()};    ///< mm, of the unloaded surface
  Vec3 normal_base{Vec3::UnitX()};  ///< outwards
  double area_mm2{4};
  double newton_per_mm{4};
};

struct UpperStrip {
  double piece_mm{2};              ///< apart, along and across
  std::size_t rows{0};             ///< across, the lowest first
  double low_mm{0};                ///< of the lowest row, along the surface above the line
  std::vector<UpperPiece> pieces;  ///< column after column along the closed line, anticlockwise
  [[nodiscard]] std::size_t columns() const { return rows == 0 ? 0 : pieces.size() / rows; }
  [[nodiscard]] const UpperPiece& at(std::size_t column, std::size_t row) const {
    return pieces[column * rows + row];
  }
};

/// Leather and lining over a last: 2 to 3 mm of some MPa and less.  Toe cap and heel counter are stiffer.
struct StripPlan {
  double low_mm{1}, high_mm{11};  ///< along the surface above the line
  double piece_mm{2};
  double newton_per_mm3{1};   ///< of the upper, for each mm of depth and mm2 of area
  double stiffened_ratio{2};  ///< of toe and heel, within a sixth of the length from the ends
  double uneven_ratio{0.2};   ///< of its waves along the line, by the seed
  std::uint64_t seed{1};
};

/// `line`: the shoe's true one, evenly spaced along the outline.
[[nodiscard]] UpperStrip upper_strip(const MadeShoe& shoe, std::span<const TrueLinePoint> line,
                                     const SE3& T_base_shoe, const StripPlan& plan);

}  // namespace biteline::sim
