// SPDX-License-Identifier: MIT
#pragma once
/// \file A smooth unknown function under a linear model: what it hides of the model's parameters.

#include <Eigen/Core>
#include <span>

namespace biteline::transfer {

/// Six parameters of a small motion, and what was measured.
inline constexpr int k_motion = 6;
using MotionRow = Eigen::Matrix<double, k_motion, 1>;

/// Of a random function round a ring of some length and across a band beside it: standard deviation 1, even
/// everywhere, alike over some mm.
struct FieldShape {
  double along_mm;
  double across_mm;
};

/// A Gaussian process with Matérn's covariance of order 5/2, by the waves that it is made of (Solin, Särkkä
/// 2020, "Hilbert space methods for reduced-rank Gaussian process regression", eq. (8), (20)): sines and
/// cosines round the ring, cosines across the band.  Some hundred waves stand for any number of places.
class FieldWaves {
 public:
  struct Domain {
    double ring_mm;
    double low_mm, high_mm;  ///< across; alike for a function of the ring alone
    double shortest_mm;      ///< shorter waves are left to the noise
  };
  explicit FieldWaves(const Domain& domain);

  [[nodiscard]] Eigen::Index count() const { return along_.size(); }
  [[nodiscard]] Eigen::VectorXd at(double along_mm, double across_mm) const;
  /// How strong each wave is in a function of this shape: variances, of which the function's own is 1.
  [[nodiscard]] Eigen::VectorXd variances(const FieldShape& shape) const;
  /// The wave that is the same everywhere.
  [[nodiscard]] Eigen::Index even() const { return 0; }
  /// The two that go once round the ring.
  [[nodiscard]] std::pair<Eigen::Index, Eigen::Index> once_round() const { return {1, 2}; }

 private:
  Domain domain_;
  Eigen::Index harmonics_, across_count_;
  Eigen::VectorXd along_, across_;  ///< of each wave, rad/mm
};

/// Measured differences y = -J motion + share * field + noise, summed up: everything that is asked afterwards
/// comes from these, whatever the field's strength.
class FieldProblem {
 public:
  struct Row {
    double along_mm, across_mm;
    MotionRow jacobian;
    double difference_mm;
    double weight;    ///< 1: the noise's own variance
    double share{1};  ///< of the field that is measured here
  };
  FieldProblem(const FieldWaves& waves, std::span<const Row> rows);

  /// With the field integrated out: the normal equations of the motion (generalised least squares), for noise
  /// of variance 1.
  struct Reduced {
    Eigen::Matrix<double, k_motion, k_motion> information;
    MotionRow slope;         ///< information * motion = -slope
    double squares;          ///< of the differences, whitened
    double log_determinant;  ///< of the differences' covariance
  };
  [[nodiscard]] Reduced reduced(const Eigen::VectorXd& wave_variances) const;
  [[nodiscard]] double rows() const { return rows_; }

 private:
  using Sides = Eigen::Matrix<double, k_motion + 1, k_motion + 1>;
  Eigen::MatrixXd waves_squared_, waves_sides_;
  Sides sides_squared_;
  double rows_;
};

}  // namespace biteline::transfer
