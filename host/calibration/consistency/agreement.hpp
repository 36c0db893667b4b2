// SPDX-License-Identifier: MIT
#pragma once
/// \file Do the places that a scan saw from two directions agree, as far as head, poses and arm are known?

#include <cstddef>
#include <optional>
#include <span>

#include "host/calibration/consistency/crossings.hpp"

namespace biteline::consistency {

struct Agreement {
  std::size_t places{0}, profiles{0}, stretches{0};
  double apart_mm{0};      ///< the two views of a place, root mean square
  double arm_sigma_mm{0};  ///< as it was counted with
  /// Chi square of `stretches` degrees of freedom where all is as stated.  One sound scan in ten thousand is
  /// above the limit.
  double statistic{0}, limit{0};
  /// What of it pictures moved by rows alone would make, or by columns alone: each of one degree of freedom.
  Vec2 moved_statistic{Vec2::Zero()};
  double moved_limit{0};
  Vec2 moved_px{Vec2::Zero()};  ///< where they would be then: columns, rows
  /// Pictures moved by so many columns or rows are told; none: it sees none of them.
  std::optional<double> tells_columns{}, tells_rows{};

  [[nodiscard]] bool enough() const;  ///< places to say anything
  [[nodiscard]] bool contradicts() const {
    return enough() && (statistic > limit || moved_statistic.maxCoeff() > moved_limit);
  }
  /// Enough, and pictures whose rows are moved by a millimetre at the shoe would not have agreed.
  [[nodiscard]] bool rows_agree() const;
  /// The same of rows and of columns.
  [[nodiscard]] bool agrees() const;
  /// That much may be between the two views.
  [[nodiscard]] double allowed_mm() const;
};

/// A place's two views are apart by the head's errors, which are the same in all places; by the arm's, which
/// are the same for a fifth of a second and new in the next; and by the points' noise.  With d the distances,
/// H their change with the head's standard deviations and W the weights by arm and points, the statistic is
/// the least of |d + H z|^2_W + |z|^2 over z: the chi square of d, whose covariance is W^-1 + H H^T. Outliers
/// count by their size and not by its square (Huber).  Pictures that are moved are one direction of d: a test
/// of that direction alone sees less of them.  `arm_sigma_mm`: of one coordinate, as the scan shows or an
/// assumption has it; what the places themselves leave open limits it.
[[nodiscard]] Agreement agreement_of(std::span<const Crossing> crossings, double arm_sigma_mm);

}  // namespace biteline::consistency
