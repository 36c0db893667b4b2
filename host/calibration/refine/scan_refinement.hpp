// SPDX-License-Identifier: MIT
#pragma once
/// \file The last word: laser plane, mounting and clock offset adjusted so that a scan agrees with itself.

#include "common/core/result.hpp"
#include "host/calibration/clock/overlap.hpp"

namespace biteline::calibration {

/// Order: normal's turns about two axes across it (rad), distance (mm); T_flange_cam's perturbation [rho;
/// theta] on the right; clock offset (s).
inline constexpr int k_refined = 10;
using RefineVector = Eigen::Matrix<double, k_refined, 1>;
using RefineMatrix = Eigen::Matrix<double, k_refined, k_refined>;

struct ScanRefinement {
  ScanModel model;
  RefineVector change{RefineVector::Zero()};
  RefineVector sigma{RefineVector::Zero()};
  double rms_before_mm{0};  ///< of surfaces seen more than once
  double rms_after_mm{0};
  std::size_t pairs{0};
};

/// Gauss-Newton on the point-to-plane distances between passes, with what the calibration knows as prior: a
/// direction that the scan does not determine stays where it was.  `prior` is the covariance of the ten
/// quantities before; plane_axes are the axes that it tells the normal's turns about.  The start is kept
/// where the passes agree no better afterwards; fails when hardly anything is seen twice.
[[nodiscard]] Result<ScanRefinement> refine_from_scan(const Scan& scan, const ScanModel& start,
                                                      const RefineMatrix& prior,
                                                      const Eigen::Matrix<double, 3, 2>& plane_axes);

}  // namespace biteline::calibration
