// SPDX-License-Identifier: MIT
#pragma once
/// \file Which part has drifted: each part is tried alone, and weighed by how well it explains what was seen.

#include <array>
#include <optional>
#include <string>

#include "host/calibration/drift/sums.hpp"

namespace biteline::drift {

struct Named {
  std::array<double, k_parts> probability{};  ///< they sum up to 1
  Part part{Part::Head};                      ///< the most probable
  Vector drift{Vector::Zero()};               ///< of that part's quantities, in fault sizes
};

/// One part has drifted, its quantities by some fault sizes each: Bayes' rule over the five.  `sums`: what
/// is left after the usual; `spread`: how many times more the scans scatter than it states, as a variance; 1
/// and more.
[[nodiscard]] Named name(const Sums& sums, double spread);

/// "laser", or "laser or mounting" where the second is not ruled out.
[[nodiscard]] std::string words_of(const Named& named);
/// The part that moved most, with its unit: "laser offset 0.11 mm".
[[nodiscard]] std::string largest_of(const Named& named);

}  // namespace biteline::drift
