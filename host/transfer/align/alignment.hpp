// SPDX-License-Identifier: MIT
#pragma once
/// \file Sample and current upper brought together: the whole registration, with the reasons why not.

#include <string>
#include <vector>

#include "host/transfer/align/evidence.hpp"
#include "host/transfer/align/icp.hpp"
#include "host/transfer/align/prepared.hpp"

namespace biteline::transfer {

struct AlignOptions {
  bool mirror{false};           ///< the sample is of the other foot
  bool grade{false};            ///< the sample is of another size
  GradingLaw law{usual_law()};  ///< of that
};

enum class Verdict {
  Aligned,
  TooLittleOverlap,
  DirectionNotFixed,
  OtherFoot,
  OtherSize,
  UpsideDown,
  OtherModel,  ///< align(): or anything that diagnose() tells from it
  NotConverged,
};

/// Of a weak direction: how far the line may move along it.
struct WeakDirection {
  double sigma_mm{0};
  std::string words{};  ///< "up and down", "along the shoe", ...
};

/// A place where the two surfaces were compared.
struct Compared {
  Eigen::Vector3f point;   ///< of the placed sample, in the upper's frame
  float difference_mm{0};  ///< > 0: the sample lies outside the upper
};

struct Alignment {
  Verdict verdict{Verdict::NotConverged};
  std::string reason{};     ///< one plain sentence when refused
  std::string next_step{};  ///< what to show so that the height is fixed; empty where it is

  bool mirrored{false};   ///< the sample's shoe frame was mirrored (y turned round) before it was placed
  Placement placement{};  ///< sample's shoe frame to the upper's base
  SE3 T_upper_sample{
      SE3::Identity()};  ///< base of the sample's scan to base of the upper's; meaningful when rigid
  bool converged{false};
  int iterations{0};
  double overlap_ratio{0};        ///< share of the sample's common surface that the upper's scan has
  double upper_overlap_ratio{0};  ///< share of the upper's surface above the line that the sample has
  double residual_rms_mm{0};      ///< of all pairs, texture and noise among them
  double shape_rms_mm{0};         ///< of the mean residuals of patches: the difference of the two shapes
  bool rim_used{false};           ///< the two collars are taken for one edge
  double same_edge_ratio{0};      ///< probability that they are; 0: not both in view
  double rim_mm{0};
  double rim_doubt_mm{0};     ///< graded: half of how far the rims have moved the line, RMS
  Belief belief{};            ///< rigid: what is left open between the placement and the truth
  Information information{};  ///< inverse of the covariance; see IcpResult
  WeakDirection weakest{};
  double line_sigma_mm{0};           ///< RMS over the line of how far the alignment may be off
  double runner_up_ratio{0};         ///< cost of the best to that of the next different start: 1 = a toss-up
  std::vector<Compared> compared{};  ///< one per 2 mm of the common surface

  [[nodiscard]] bool accepted() const { return verdict == Verdict::Aligned; }

  /// Where a point of the sample's line and its normal, given in the sample's shoe frame, lie on the upper.
  struct OnLine {
    Vec3 point, normal;
  };
  [[nodiscard]] OnLine placed(const OnLine& on_sample) const;
  /// Of the other foot, where the sample was mirrored.
  [[nodiscard]] OnLine as_used(const OnLine& on_sample) const;
};

/// Any place and yaw, tilt to 10 degrees.  Never fails: a refusal is an Alignment with its verdict and
/// reason.
[[nodiscard]] Alignment align(const Sample& sample, const Upper& upper, const AlignOptions& options);

/// The same of another sample, onto its shoe frame.  Its line is known, too, and counts.
[[nodiscard]] Alignment align_samples(const Sample& sample, const Sample& other, const AlignOptions& options);

}  // namespace biteline::transfer
