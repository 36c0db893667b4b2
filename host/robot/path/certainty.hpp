// SPDX-License-Identifier: MIT
#pragma once
/// \file How certain a path is along what it works on, and where it is not certain enough.

#include <optional>
#include <vector>

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

/// A stretch of the path whose U95 is above the tolerance, or not known.
struct UncertainPlace {
  double from_mm{0};  ///< along the path
  double to_mm{0};
  std::optional<double> u95_mm{};  ///< the largest; none: somewhere not known
};

/// Of the path as it is planned, and the tool that works along it.
struct Certainty {
  std::optional<double>
      u95_mm{};     ///< the largest along the whole processed length; none: somewhere not known
  double at_mm{0};  ///< where, along the path
  std::vector<UncertainPlace> places{};  ///< in order; none without a tolerance
  /// Of the tool's true tip from the true line along all that is worked; none: U95 is not known.
  std::optional<double> tip_bound_mm{};
};

/// Of the waypoints on the line, the overlap among them.
[[nodiscard]] Certainty certainty_of(const PlannedPath& path, const std::optional<double>& tolerance_mm);

}  // namespace biteline::path
