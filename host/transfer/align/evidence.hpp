// SPDX-License-Identifier: MIT
#pragma once
/// \file What the wall and the collar's edge each know of where the sample lies on the upper, weighed
/// together.

#include <vector>

#include "host/transfer/align/icp.hpp"
#include "host/transfer/align/prepared.hpp"
#include "host/transfer/align/smooth_field.hpp"

namespace biteline::transfer {

/// A normal distribution of the small motion [rho; theta] (mm, rad; right perturbation of T_target_source)
/// that is left between the placement and the truth.
struct BeliefPart {
  double weight;
  Twist mean;
  Eigen::Matrix<double, k_motion, k_motion> covariance;
};

/// A mixture: how the wall's difference varies is not known, nor whether the two collars are one edge.
/// Weights sum up to 1.
using Belief = std::vector<BeliefPart>;

struct FitEvidence {
  SE3 T_target_source{SE3::Identity()};  ///< the likeliest
  Belief belief{};
  bool settled{false};            ///< weighed again from there, it stays
  bool edges_compared{false};     ///< both scans show an edge, and they lie side by side
  double same_edge_ratio{0};      ///< probability that they are one edge
  double edge_mm{0};              ///< robust standard deviation of their difference in height
  FieldShape likeliest_shape{};   ///< of the two walls' difference
  double difference_sigma_mm{0};  ///< of it, likeliest
};

/// Lasts differ smoothly, and a smooth difference looks like a motion: on a wall that is nearly upright,
/// mostly like one in height.  So the difference is a random function whose strength and reach the
/// comparison itself tells (restricted likelihood), and the motion is what it leaves (generalised least
/// squares).  The collar's edge sees the height alone, but it may be cut elsewhere: wavy, which shows, or by
/// the same all the way round, which only the wall can contradict.
/// Pre: `start` is the surface's own best fit, rigid.
[[nodiscard]] FitEvidence weigh_evidence(const Sample& sample, const Upper& upper,
                                         const NearestTable& upper_table, const Placement& start);

}  // namespace biteline::transfer
