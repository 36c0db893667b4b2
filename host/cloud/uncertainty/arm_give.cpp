// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/arm_give.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstddef>

namespace biteline::uncertainty {
namespace {

constexpr double k_half_s = 0.05;
constexpr std::size_t k_least_in_fit = 5;
constexpr double k_m_per_mm = 1e-3;

/// Of the flange's point that is `at` now.
double squared_acceleration(std::span<const CarriedPoint> near, const CarriedPoint& at) {
  const Vec3 point_flange = at.T_base_flange.inverse(Eigen::Isometry) * at.point_base;
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
  for (const CarriedPoint& other : near) {
    const double u = (other.time_s - at.time_s) / k_half_s;
    const Eigen::Vector4d terms{1, u, u * u, u * u * u};
    normal += terms * terms.transpose();
    right += terms * (other.T_base_flange * point_flange - at.point_base).transpose();
  }
  const Eigen::Matrix<double, 4, 3> fit = normal.ldlt().solve(right);
  return (fit.row(2) * (2 * k_m_per_mm / (k_half_s * k_half_s))).squaredNorm();
}

}  // namespace

std::string_view to_string(ArmSource source) {
  switch (source) {
    case ArmSource::Table:
      return "table";
    case ArmSource::Stated:
      return "stated";
    case ArmSource::EarlierScans:
      return "earlier scans";
    case ArmSource::Assumed:
      return "assumed";
  }
  return "";
}

std::vector<double> squared_accelerations(std::span<const CarriedPoint> points) {
  const auto no_later = [](const CarriedPoint& a, const CarriedPoint& b) { return !(a.time_s < b.time_s); };
  if (points.size() < k_least_in_fit || std::ranges::adjacent_find(points, no_later) != points.end())
    return {};
  std::vector<double> squared;
  squared.reserve(points.size());
  std::size_t first = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const CarriedPoint& at = points[i];
    while (end < points.size() && points[end].time_s <= at.time_s + k_half_s) ++end;
    while (points[first].time_s < at.time_s - k_half_s) ++first;
    // Few within reach: its neighbours in the row.
    constexpr std::size_t k_beside = k_least_in_fit / 2;
    const std::size_t to = std::min(points.size(), std::max({end, i + k_beside + 1, k_least_in_fit}));
    const std::size_t from = std::min({first, i - std::min(i, k_beside), to - k_least_in_fit});
    squared.push_back(squared_acceleration(points.subspan(from, to - from), at));
  }
  return squared;
}

}  // namespace biteline::uncertainty
