// SPDX-License-Identifier: MIT
#include "host/transfer/align/smooth_field.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace biteline::transfer {
namespace {

constexpr double k_two_pi = 2 * std::numbers::pi;

/// Cosines end level at the domain's ends: these lie so far outside the band.
constexpr double k_margin_mm = 15;

}  // namespace

FieldWaves::FieldWaves(const Domain& domain) : domain_{domain} {
  const bool band = domain.high_mm > domain.low_mm;
  domain_.low_mm -= k_margin_mm;
  domain_.high_mm += k_margin_mm;
  const double width_mm = domain_.high_mm - domain_.low_mm;
  const auto of = [&](double way_mm) {
    return std::max<Eigen::Index>(1, static_cast<Eigen::Index>(way_mm / domain.shortest_mm));
  };
  harmonics_ = of(domain.ring_mm);
  across_count_ = band ? 1 + of(2 * width_mm) : 1;
  const Eigen::Index round_count = 1 + 2 * harmonics_;
  along_.resize(round_count * across_count_);
  across_.resize(along_.size());
  for (Eigen::Index j = 0; j < across_count_; ++j) {
    for (Eigen::Index i = 0; i < round_count; ++i) {
      const Eigen::Index harmonic = (i + 1) / 2;  // a cosine and a sine of each
      along_[j * round_count + i] = k_two_pi * static_cast<double>(harmonic) / domain.ring_mm;
      across_[j * round_count + i] = std::numbers::pi * static_cast<double>(j) / width_mm;
    }
  }
}

Eigen::VectorXd FieldWaves::at(double along_mm, double across_mm) const {
  const Eigen::Index round_count = 1 + 2 * harmonics_;
  Eigen::VectorXd round(round_count), out(count());
  round[0] = 1;
  const double turn_rad = k_two_pi * along_mm / domain_.ring_mm;
  for (Eigen::Index h = 1; h <= harmonics_; ++h) {
    round[2 * h - 1] = std::numbers::sqrt2 * std::cos(static_cast<double>(h) * turn_rad);
    round[2 * h] = std::numbers::sqrt2 * std::sin(static_cast<double>(h) * turn_rad);
  }
  const double share = (across_mm - domain_.low_mm) / (domain_.high_mm - domain_.low_mm);
  for (Eigen::Index j = 0; j < across_count_; ++j) {
    const double height =
        j == 0 ? 1 : std::numbers::sqrt2 * std::cos(std::numbers::pi * static_cast<double>(j) * share);
    out.segment(j * round_count, round_count) = height * round;
  }
  return out;
}

Eigen::VectorXd FieldWaves::variances(const FieldShape& shape) const {
  constexpr double k_order = 2.5;
  const double dimensions = across_count_ > 1 ? 2 : 1;
  const Eigen::ArrayXd squared =
      (along_.array() * shape.along_mm).square() + (across_.array() * shape.across_mm).square();
  const Eigen::ArrayXd density = (2 * k_order + squared).pow(-(k_order + dimensions / 2));
  return density / density.sum();
}

FieldProblem::FieldProblem(const FieldWaves& waves, std::span<const Row> rows)
    : rows_{static_cast<double>(rows.size())} {
  Eigen::MatrixXd field(rows.size(), waves.count());
  Eigen::Matrix<double, Eigen::Dynamic, k_motion + 1> sides(rows.size(), k_motion + 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const auto at = static_cast<Eigen::Index>(i);
    const double root = std::sqrt(row.weight);
    field.row(at) = root * row.share * waves.at(row.along_mm, row.across_mm).transpose();
    sides.row(at).head<k_motion>() = root * row.jacobian.transpose();
    sides(at, k_motion) = root * row.difference_mm;
  }
  waves_squared_.noalias() = field.transpose() * field;
  waves_sides_.noalias() = field.transpose() * sides;
  sides_squared_.noalias() = sides.transpose() * sides;
}

FieldProblem::Reduced FieldProblem::reduced(const Eigen::VectorXd& wave_variances) const {
  const Eigen::VectorXd roots = wave_variances.cwiseSqrt();
  Eigen::MatrixXd inner = roots.asDiagonal() * waves_squared_ * roots.asDiagonal();
  inner.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> factor{inner};
  Eigen::MatrixXd hidden = roots.asDiagonal() * waves_sides_;
  factor.matrixL().solveInPlace(hidden);
  const Sides left = sides_squared_ - hidden.transpose() * hidden;
  return {.information = left.topLeftCorner<k_motion, k_motion>(),
          .slope = left.topRightCorner<k_motion, 1>(),
          .squares = left(k_motion, k_motion),
          .log_determinant = 2 * factor.matrixLLT().diagonal().array().log().sum()};
}

}  // namespace biteline::transfer
