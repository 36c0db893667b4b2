// SPDX-License-Identifier: MIT
#pragma once
/// \file Sides whose bite line is known, as the fits of the curve take them.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/bite_line/curve/crease_looks.hpp"
#include "host/bite_line/curve/raster.hpp"
#include "tests/bench/line/curve_cases.hpp"

namespace biteline::bench {

/// A side, and the known line on it.
struct Held {
  std::string kind, group, name;
  bite_line::Raster raster;
  std::vector<Vec2> truth;  ///< s, z
  double truth_mm{0};
  double turn_mm{0};
  bool plain{true};  ///< a made shoe's line is plain to see

  /// Without labels, yet on its picture (--pictures) the curve is the line: look again when that changes.
  [[nodiscard]] bool right_by_eye() const;
  [[nodiscard]] bool made() const { return kind != "shape" && kind != "unlabelled"; }
};

/// None where the cloud holds no shoe.
[[nodiscard]] std::optional<Held> held_of(const CurveCase& of);

/// Over the side, once round (mm).
[[nodiscard]] double off_mm(const Vec2& a, const Vec2& b, double turn_mm);
[[nodiscard]] double least_off_mm(const Vec2& place, const std::vector<Vec2>& line, double turn_mm);
/// Whether the line is known above or below a place.
[[nodiscard]] bool known_beside(const Held& held, const Vec2& place);

/// A place and direction of a curve over the raster.
struct Passing {
  int row, col;
  std::size_t direction;
};

/// The truth's `i`-th place; its own error lets it lie where the surface turns most beside it.
[[nodiscard]] std::optional<Passing> passing_at(const Held& held, const bite_line::CreaseLooks& looks,
                                                std::size_t i);

}  // namespace biteline::bench
