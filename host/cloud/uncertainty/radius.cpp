// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/radius.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace biteline::uncertainty {
namespace {

constexpr double k_share = 0.95;
constexpr double k_least_mm = 1e-6;
constexpr int k_halvings = 26;

// Positive half of the sixteen-point Gauss-Legendre rule (Abramowitz, Stegun, table 25.4).
constexpr std::array<double, 8> k_nodes{0.0950125098376374, 0.2816035507792589, 0.4580167776572274,
                                        0.6178762444026438, 0.7554044083550030, 0.8656312023878318,
                                        0.9445750230732326, 0.9894009349916499};
constexpr std::array<double, 8> k_weights{0.1894506104550685, 0.1826034150449236, 0.1691565193950025,
                                          0.1495959888165767, 0.1246289712555339, 0.0951585116824928,
                                          0.0622535239386479, 0.0271524594117541};

double chance_of_normal(double limit, double sigma) {
  return std::erf(limit / (std::numbers::sqrt2 * std::max(sigma, k_least_mm)));
}

}  // namespace

Axes principal_axes(const Eigen::Matrix2d& covariance_mm2) {
  const double half = 0.5 * (covariance_mm2(0, 0) + covariance_mm2(1, 1));
  const double apart = std::hypot(0.5 * (covariance_mm2(0, 0) - covariance_mm2(1, 1)), covariance_mm2(0, 1));
  return {.major_mm = std::sqrt(std::max(half + apart, 0.0)),
          .minor_mm = std::sqrt(std::max(half - apart, 0.0))};
}

double chance_within(const Axes& axes, double radius_mm) {
  const double major_mm = std::max(axes.major_mm, k_least_mm);
  if (!(radius_mm > 0)) return 0;
  // x = r sin t keeps the root at the rim smooth.  What lies beyond eight deviations is nothing.
  const double end = std::asin(std::min(1.0, 8 * major_mm / radius_mm));
  double sum = 0;
  for (std::size_t i = 0; i < k_nodes.size(); ++i) {
    for (const double sign : {-1.0, 1.0}) {
      const double t = 0.5 * end * (1 + sign * k_nodes[i]);
      const double x = radius_mm * std::sin(t);
      const double density = std::exp(-0.5 * x * x / (major_mm * major_mm));
      sum += k_weights[i] * density * std::cos(t) * chance_of_normal(radius_mm * std::cos(t), axes.minor_mm);
    }
  }
  return std::min(1.0, sum * 0.5 * end * radius_mm * std::sqrt(2 / std::numbers::pi) / major_mm);
}

namespace {

/// Radius that holds `share` of a distribution with a major deviation of 1.
double radius_of(double minor, double share) {
  double low = 0, high = 8;
  for (int i = 0; i < k_halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (chance_within({.major_mm = 1, .minor_mm = minor}, middle) < share ? low : high) = middle;
  }
  return high;
}

/// radius_of() at 95 % over the minor deviation, worked out once: straight lines between 64 places are good
/// to 1e-4.
double radius_of_95(double minor) {
  constexpr std::size_t k_steps = 64;
  static const std::array<double, k_steps + 1> k_table = [] {
    std::array<double, k_steps + 1> table{};
    for (std::size_t i = 0; i <= k_steps; ++i)
      table.at(i) = radius_of(static_cast<double>(i) / k_steps, k_share);
    return table;
  }();
  const double place = std::clamp(minor, 0.0, 1.0) * k_steps;
  const auto before = std::min(static_cast<std::size_t>(place), k_steps - 1);
  const double fraction = place - static_cast<double>(before);
  return (1 - fraction) * k_table.at(before) + fraction * k_table.at(before + 1);
}

}  // namespace

double u95_mm(const Axes& axes, double hold, double other_mm) {
  // One in a thousand elsewhere widens the circle by less than a hundredth.
  constexpr double k_sure = 0.999;
  const double major_mm = std::max(axes.major_mm, k_least_mm);
  if (hold >= k_sure) return major_mm * radius_of_95(axes.minor_mm / major_mm);
  hold = std::clamp(hold, 0.0, 1.0);
  const auto chance = [&](double radius_mm) {
    const double there = other_mm <= radius_mm ? 1 - hold : 0;
    return hold * chance_within(axes, radius_mm) + there;
  };
  double low = 0;
  double high = 8 * major_mm + (hold > k_share ? 0 : other_mm);
  for (int i = 0; i < k_halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (chance(middle) < k_share ? low : high) = middle;
  }
  return high;
}

}  // namespace biteline::uncertainty
