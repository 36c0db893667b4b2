// SPDX-License-Identifier: MIT
#pragma once
/// \file How far the tool may be off the line at most along a whole path, said before it is sent.

#include <optional>

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

/// What the host knows of it.
struct TipParts {
  std::optional<double>
      line_u95_mm{};     ///< the largest along the path: light, head, its mounting; none: not known
  double give_mm{0};     ///< the largest of the arm along the path
  double tip_u95_mm{0};  ///< of the taught tip; 0: it was not taught, and the process's is believed
};

/// The arm's largest give on the line, across it, mm.
[[nodiscard]] double largest_give_mm(const PlannedPath& path, const kinematics::ArmModel& arm);

[[nodiscard]] TipParts parts_of(const PlannedPath& path, const std::optional<double>& line_u95_mm);

/// In 95 of 100 shoes the largest distance of the tool's true tip from the true line, along all that is
/// worked, is at most this, mm; none: the line's U95 is not known.  Split-conformal over whole shoes (Vovk
/// 2005): k_bound_factor times what the parts add up to.
[[nodiscard]] std::optional<double> tip_bound_mm(const TipParts& parts);
/// What the parts add up to, mm: the arm's give beside what is not known of line and tip.
[[nodiscard]] std::optional<double> tip_sum_mm(const TipParts& parts);

/// How likely the largest distance is beyond `tolerance_mm`, 0 to 1, as a normal distribution of what comes
/// of a sum has it: the consumer's risk of a path that is sent; what is left to 1 is the producer's of one
/// that is not (JCGM 106:2012, 8.4).  None: the line's U95 is not known.
[[nodiscard]] std::optional<double> risk_beyond(const TipParts& parts, double tolerance_mm);

/// Of the largest true distance over the sum, as bound_factor.py finds them in bench_tip's rows
/// (docs/tip.md): the bound's factor; mean and standard deviation.
inline constexpr double k_bound_factor = 1.46, k_mean_ratio = 0.77, k_ratio_sigma = 0.27;

}  // namespace biteline::path
