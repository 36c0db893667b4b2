// SPDX-License-Identifier: MIT
#pragma once
/// \file The border for numbers from outside (files, wire, command line, controllers): finite and in a range.

#include <cmath>

namespace biteline {

/// Nothing that a shoe, a head or an arm has to do with lies farther away: 100 m.
inline constexpr double k_far_mm = 1e5;

/// Written so that NaN is outside; so is every infinity, since a limit is finite.
struct NumberRange {
  double minimum{-1e9};
  double maximum{1e9};

  [[nodiscard]] bool holds(double value) const {
    // The quiet comparisons: a plain >= with NaN raises the processor's invalid flag.
    return std::isgreaterequal(value, minimum) && std::islessequal(value, maximum);
  }
};

inline constexpr NumberRange k_plausible_mm{.minimum = -k_far_mm, .maximum = k_far_mm};

/// A place in mm, of any vector type with x(), y(), z().
template <class Vector>
[[nodiscard]] bool is_plausible_place(const Vector& place) {
  return k_plausible_mm.holds(static_cast<double>(place.x())) &&
         k_plausible_mm.holds(static_cast<double>(place.y())) &&
         k_plausible_mm.holds(static_cast<double>(place.z()));
}

}  // namespace biteline
