// SPDX-License-Identifier: MIT
#pragma once
/// \file The local step of registration from a start: surface, then rims, and for another size how its
/// sections grew.

#include "host/transfer/align/evidence.hpp"
#include "host/transfer/align/icp.hpp"
#include "host/transfer/align/prepared.hpp"

namespace biteline::transfer {

/// What is brought together.  References only for the call.
struct FitTask {
  const Sample& sample;
  const Upper& upper;
  const NearestTable& upper_table;
  const LineBeside* upper_line{nullptr};  ///< where the upper is a sample, too
};

/// One way in which the sample lies on the upper.
struct Fit {
  IcpResult icp{};
  bool rim_used{false};
  double rim_shift_mm{0};     ///< graded: how far the rims have moved the line, RMS
  FitEvidence evidence{};     ///< rigid
  std::vector<Pair> pairs{};  ///< of the surface
  double shape_rms_mm{0};     ///< of the mean residuals of patches: noise and texture average out, the
                              ///< difference of two shapes does not
};

/// By the surface, then by all that both scans show.
[[nodiscard]] Fit fit_rigid(const FitTask& task, const Placement& start);

/// Moves a rigid fit to where wall and collar's edge together have it, and says how sure that is.
void weigh(const FitTask& task, Fit& fit);

/// Of another size: by the surface and the rims, weighed against the law (maximum a posteriori).
[[nodiscard]] Fit fit_graded(const FitTask& task, const Placement& start, const GradingLaw& law);

}  // namespace biteline::transfer
