// SPDX-License-Identifier: MIT
#include "host/calibration/consistency/agreement.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "host/geometry/robust.hpp"

namespace biteline::consistency {
namespace {

using Vector = Eigen::Matrix<double, uncertainty::k_parameters, 1>;
using Matrix = Eigen::Matrix<double, uncertainty::k_parameters, uncertainty::k_parameters>;

constexpr std::size_t k_least_places = 20, k_least_profiles = 8;
/// An arm's error is its own for so long (uncertainty::ArmSway).
constexpr double k_stretch_s = 0.2;
/// Stripe, texture and the surface fitted through the neighbours.
constexpr double k_least_noise_mm = 0.01, k_most_noise_mm = 0.03;
/// What the head's quantities, free, cannot explain is a part of the arm's own error: half of it and more.
constexpr double k_unexplained = 2.5;
/// Beyond, a distance counts by its size.
constexpr double k_huber = 3;
/// Of a normal distribution: one in ten thousand.
constexpr double k_rare = 3.719;
/// One in ten thousand of a normal distribution, on both sides: 3.891 squared.
constexpr double k_moved_limit = 15.14;
/// About a millimetre at the shoe.
constexpr double k_most_px = 12;

/// Wilson and Hilferty, "The distribution of chi-square", 1931.
double rare_chi_square(double freedom) {
  const double a = 2 / (9 * freedom);
  return freedom * std::pow(1 - a + k_rare * std::sqrt(a), 3);
}

struct Weighted {
  Crossing crossing;
  double share;  ///< a stretch is one observation
};

std::vector<Weighted> weighted(std::span<const Crossing> crossings, Agreement& agreement) {
  std::map<long, std::size_t> stretches;
  std::map<std::uint32_t, std::size_t> profiles;
  const auto stretch_of = [](const Crossing& c) { return std::lround(std::floor(c.time_s / k_stretch_s)); };
  for (const Crossing& crossing : crossings) {
    ++stretches[stretch_of(crossing)];
    ++profiles[crossing.frame];
  }
  std::vector<Weighted> rows;
  for (const Crossing& crossing : crossings)
    rows.push_back({crossing, 1 / static_cast<double>(stretches[stretch_of(crossing)])});
  agreement.places = crossings.size();
  agreement.profiles = profiles.size();
  agreement.stretches = stretches.size();
  return rows;
}

struct Fit {
  Vector z{Vector::Zero()};
  Matrix information{Matrix::Zero()};
  double cost{0};
};

/// `held`: weight of z = 0.
template <typename Variance>
Fit fit(const std::vector<Weighted>& rows, const Variance& variance_mm2, double held) {
  Fit fit;
  constexpr int k_rounds = 4;
  for (int round = 0; round < k_rounds; ++round) {
    fit.information.setZero();
    Vector pull = Vector::Zero();
    for (const Weighted& row : rows) {
      const double sigma_mm = std::sqrt(variance_mm2(row.crossing));
      const double off = std::abs(row.crossing.apart_mm + row.crossing.moves.dot(fit.z)) / sigma_mm;
      const double weight = row.share / (sigma_mm * sigma_mm) * (off > k_huber ? k_huber / off : 1);
      fit.information += weight * row.crossing.moves.transpose() * row.crossing.moves;
      pull -= weight * row.crossing.apart_mm * row.crossing.moves.transpose();
    }
    const Matrix all = fit.information + held * Matrix::Identity();
    fit.z = all.ldlt().solve(pull);
  }
  fit.cost = held * fit.z.squaredNorm();
  for (const Weighted& row : rows) {
    const double off = std::abs(row.crossing.apart_mm + row.crossing.moves.dot(fit.z)) /
                       std::sqrt(variance_mm2(row.crossing));
    fit.cost += row.share * (off > k_huber ? k_huber * (2 * off - k_huber) : off * off);
  }
  return fit;
}

/// What is left where the head is free: the points' noise, and a part of the arm's error.
double left_mm(const std::vector<Weighted>& rows) {
  constexpr double k_start_mm2 = 0.02 * 0.02, k_free = 1e-3;
  const Fit free = fit(
      rows, [&](const Crossing&) { return k_start_mm2; }, k_free);
  std::vector<double> off;
  for (const Weighted& row : rows)
    off.push_back(std::abs(row.crossing.apart_mm + row.crossing.moves.dot(free.z)));
  return geometry::k_sigma_per_mad * geometry::median_of(std::move(off));
}

/// Moved pictures are a direction P of the distances d, whose covariance is S = W^-1 + H H^T: of these P^T
/// S^-1 P and P^T S^-1 d.
template <typename Variance>
void look_for_move(const std::vector<Weighted>& rows, const Variance& variance_mm2, const Fit& fit,
                   Agreement& agreement) {
  using Both = Eigen::Matrix<double, uncertainty::k_parameters, 2>;
  Both HtWP = Both::Zero();
  Vector HtWd = Vector::Zero();
  Eigen::Matrix2d PtWP = Eigen::Matrix2d::Zero();
  Vec2 PtWd = Vec2::Zero();
  for (const Weighted& row : rows) {
    const Crossing& c = row.crossing;
    const double sigma_mm = std::sqrt(variance_mm2(c));
    const double off = std::abs(c.apart_mm + c.moves.dot(fit.z)) / sigma_mm;
    const double weight = row.share / (sigma_mm * sigma_mm) * (off > k_huber ? k_huber / off : 1);
    HtWP += weight * c.moves.transpose() * c.per_px;
    HtWd += weight * c.apart_mm * c.moves.transpose();
    PtWP += weight * c.per_px.transpose() * c.per_px;
    PtWd += weight * c.apart_mm * c.per_px.transpose();
  }
  const Matrix held = fit.information + Matrix::Identity();
  const auto solver = held.ldlt();
  const Eigen::Matrix2d seen = PtWP - HtWP.transpose() * solver.solve(HtWP);
  const Vec2 pull = PtWd - HtWP.transpose() * solver.solve(HtWd);
  agreement.moved_limit = k_moved_limit;
  const auto tells = [&](int i) {
    return seen(i, i) > 0 ? std::optional{std::sqrt(k_moved_limit / seen(i, i))} : std::nullopt;
  };
  agreement.tells_columns = tells(0);
  agreement.tells_rows = tells(1);
  for (int i = 0; i < 2; ++i) {
    if (!(seen(i, i) > 0)) continue;
    agreement.moved_px[i] = pull[i] / seen(i, i);
    agreement.moved_statistic[i] = pull[i] * pull[i] / seen(i, i);
  }
}

}  // namespace

bool Agreement::enough() const {
  return places >= k_least_places && profiles >= k_least_profiles;
}

bool Agreement::rows_agree() const {
  return enough() && !contradicts() && tells_rows && *tells_rows <= k_most_px;
}

bool Agreement::agrees() const {
  return rows_agree() && tells_columns && *tells_columns <= k_most_px;
}

double Agreement::allowed_mm() const {
  const double over = std::max(statistic / limit, moved_statistic.maxCoeff() / moved_limit);
  return over > 0 ? apart_mm / std::sqrt(over) : apart_mm;
}

Agreement agreement_of(std::span<const Crossing> crossings, double arm_sigma_mm) {
  Agreement agreement;
  const std::vector<Weighted> rows = weighted(crossings, agreement);
  if (!agreement.enough()) return agreement;
  double sum_mm2 = 0, shares = 0;
  for (const Weighted& row : rows) {
    sum_mm2 += row.share * row.crossing.apart_mm * row.crossing.apart_mm;
    shares += row.share;
  }
  agreement.apart_mm = std::sqrt(sum_mm2 / shares);
  const double left = left_mm(rows);
  // Two views: twice the arm's variance.
  agreement.arm_sigma_mm = std::min(arm_sigma_mm, k_unexplained * left / std::sqrt(2.0));
  const double noise_mm = std::clamp(left, k_least_noise_mm, k_most_noise_mm);
  const double least_mm2 = noise_mm * noise_mm + 2 * agreement.arm_sigma_mm * agreement.arm_sigma_mm;
  const auto variance_mm2 = [&](const Crossing& c) { return least_mm2 + c.pose_sigma_mm * c.pose_sigma_mm; };
  const Fit held = fit(rows, variance_mm2, 1);
  agreement.statistic = held.cost;
  agreement.limit = rare_chi_square(static_cast<double>(agreement.stretches));
  look_for_move(rows, variance_mm2, held, agreement);
  return agreement;
}

}  // namespace biteline::consistency
