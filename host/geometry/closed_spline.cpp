// SPDX-License-Identifier: MIT
#include "host/geometry/closed_spline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/contracts.hpp"

namespace biteline::geometry {

namespace {

/// Solves a x = d for a cyclic tridiagonal, diagonally dominant matrix (Sherman and Morrison on Thomas'
/// algorithm).
std::vector<double> solve_cyclic(const std::vector<double>& lower, std::vector<double> diagonal,
                                 const std::vector<double>& upper, std::vector<double> right) {
  const std::size_t n = diagonal.size();
  const double corner_low = upper[n - 1];  // row n - 1, column 0
  const double corner_high = lower[0];     // row 0, column n - 1
  const double gamma = -diagonal[0];
  std::vector<double> u(n, 0.0);
  u[0] = gamma;
  u[n - 1] = corner_low;
  diagonal[0] -= gamma;
  diagonal[n - 1] -= corner_low * corner_high / gamma;
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = lower[i] / diagonal[i - 1];
    diagonal[i] -= factor * upper[i - 1];
    right[i] -= factor * right[i - 1];
    // The corner's influence falls by a quarter from knot to knot: cut before it underflows.
    if (std::abs(u[i - 1]) > 1e-100) u[i] -= factor * u[i - 1];
  }
  right[n - 1] /= diagonal[n - 1];
  u[n - 1] /= diagonal[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) {
    right[i] = (right[i] - upper[i] * right[i + 1]) / diagonal[i];
    u[i] = (u[i] - (std::abs(u[i + 1]) > 1e-100 ? upper[i] * u[i + 1] : 0.0)) / diagonal[i];
  }
  const double share =
      (right[0] + right[n - 1] * corner_high / gamma) / (1 + u[0] + u[n - 1] * corner_high / gamma);
  for (std::size_t i = 0; i < n; ++i) right[i] -= share * u[i];
  return right;
}

}  // namespace

ClosedSpline::ClosedSpline(std::vector<Knot> knots, double turn_mm)
    : knots_{std::move(knots)}, turn_mm_{turn_mm} {
  const std::size_t n = knots_.size();
  BITELINE_EXPECTS(n >= 3);
  const auto step = [&](std::size_t i) {
    return i + 1 < n ? knots_[i + 1].at_mm - knots_[i].at_mm
                     : knots_[0].at_mm + turn_mm_ - knots_[n - 1].at_mm;
  };
  const auto rise = [&](std::size_t i) { return (knots_[(i + 1) % n].value - knots_[i].value) / step(i); };
  std::vector<double> lower(n), diagonal(n), upper(n), right(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = (i + n - 1) % n;
    lower[i] = step(before);
    upper[i] = step(i);
    diagonal[i] = 2 * (lower[i] + upper[i]);
    right[i] = 6 * (rise(i) - rise(before));
  }
  bend_ = solve_cyclic(lower, std::move(diagonal), upper, std::move(right));
}

ClosedSpline::Sample ClosedSpline::at(double place_mm) const {
  const auto above = std::upper_bound(knots_.begin(), knots_.end(), place_mm,
                                      [](double place, const Knot& knot) { return place < knot.at_mm; });
  return before_knot(static_cast<std::size_t>(above - knots_.begin()), place_mm);
}

std::vector<ClosedSpline::Sample> ClosedSpline::every(double step_mm, std::size_t count) const {
  std::vector<Sample> samples;
  samples.reserve(count);
  std::size_t above = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double place_mm = static_cast<double>(i) * step_mm;
    while (above < knots_.size() && knots_[above].at_mm <= place_mm) ++above;
    samples.push_back(before_knot(above, place_mm));
  }
  return samples;
}

ClosedSpline::Sample ClosedSpline::before_knot(std::size_t above, double place_mm) const {
  const std::size_t n = knots_.size();
  const std::size_t i = above == 0 ? n - 1 : above - 1;
  const std::size_t j = above == n ? 0 : above;
  const double from = knots_[i].at_mm - (above == 0 ? turn_mm_ : 0.0);
  const double h = (knots_[j].at_mm + (above == n ? turn_mm_ : 0.0)) - from;
  const double b = (place_mm - from) / h;
  const double a = 1 - b;
  return {.value = a * knots_[i].value + b * knots_[j].value +
                   ((a * a * a - a) * bend_[i] + (b * b * b - b) * bend_[j]) * h * h / 6,
          .slope = (knots_[j].value - knots_[i].value) / h +
                   ((3 * b * b - 1) * bend_[j] - (3 * a * a - 1) * bend_[i]) * h / 6,
          .interval_mm = h};
}

}  // namespace biteline::geometry
