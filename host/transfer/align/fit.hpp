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
};

/// One way in which the sample lies on the upper.
struct Fit {
  IcpResult icp{};
  bool rim_used{false};
  double rim_shift_mm{0};     ///< graded: how far the rims have moved the line, RMS
  FitEvidence evidence{};     ///< rigid
  GradeTie tie{};             ///< as chosen, when graded
  std::vector<Pair> pairs{};  ///< of the surface
  double shape_rms_mm{0};     ///< of the mean residuals of patches: noise and texture average out, the
                              ///< difference of two shapes does not
  double rival_mm{0};  ///< graded: RMS over the line of how far another reading of the sizes would move it
};

/// By the surface, then by all that both scans show.
[[nodiscard]] Fit fit_rigid(const FitTask& task, const Placement& start);

/// Moves a rigid fit to where wall and collar's edge together have it, and says how sure that is.
void weigh(const FitTask& task, Fit& fit);

/// The wall's shape tells only weakly how much higher a shoe of another size is (a hundredth: 0.4 mm at the
/// line), and the rim only together with it.  But sizes are graded by a rule: sections stay, or grow as the
/// length does, in height, in breadth or in both.  Each rule is fitted; the one that fits best is taken when
/// section and height left free fit no better than chance would have it, else the free fit.
[[nodiscard]] Fit fit_graded(const FitTask& task, const Placement& start);

}  // namespace biteline::transfer
