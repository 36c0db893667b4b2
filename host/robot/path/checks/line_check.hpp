// SPDX-License-Identifier: MIT
#pragma once
/// \file Named checks with figures, and those a line must pass before a path is made of it.

#include <string>
#include <vector>

#include "host/cloud/closed_line.hpp"

namespace biteline::path {

/// One condition, its figure, and where it is worst.
struct Check {
  std::string name;  ///< "closed", "reach"
  bool passed{false};
  double value{0};
  double limit{0};
  std::string unit;
  double arc_mm{-1};   ///< place along the line, -1: no single place
  std::string detail;  ///< a plain sentence when failed
};

[[nodiscard]] bool all_passed(const std::vector<Check>& checks);

/// Closed, evenly spaced, without self-crossing, anticlockwise, normals outward and at right angles to the
/// line, whose directions are taken from its places; and at most a tenth of it flagged, which a person must
/// settle else.  A line that holds no numbers, or too many points, has
/// one failed check and no other.
[[nodiscard]] std::vector<Check> check_line(const cloud::ClosedLine& line);

}  // namespace biteline::path
