// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/core/contracts.hpp"

namespace biteline::sim {

namespace {

/// A common sports shoe's sole seen from above, right foot, as parts of its length; anticlockwise from the
/// heel.
constexpr std::array<std::array<double, 2>, Outline::k_control_points> k_right_foot{{
    {-0.010, 0.000}, {0.010, -0.065}, {0.080, -0.105}, {0.180, -0.120}, {0.290, -0.118}, {0.400, -0.118},
    {0.500, -0.132}, {0.600, -0.156}, {0.700, -0.174}, {0.800, -0.166}, {0.900, -0.126}, {0.980, -0.062},
    {1.005, 0.015},  {0.975, 0.085},  {0.900, 0.140},  {0.800, 0.176},  {0.700, 0.186},  {0.600, 0.180},
    {0.500, 0.164},  {0.400, 0.148},  {0.290, 0.138},  {0.180, 0.130},  {0.080, 0.110},  {0.010, 0.065},
}};

/// Table steps per control point: the arc length between two entries is then below 0.1 mm, its error below
/// 1e-6 mm.
constexpr int k_table_steps = 512;

/// 1 at the middle of a bell of the given half width, 0 from there on.
double hump(double x, double middle, double half_width) {
  const double away = std::min(std::abs(x - middle) / half_width, 1.0);
  return 0.5 * (1 + std::cos(std::numbers::pi * away));
}

/// The i-th place of a form of length and breadth 1, anticlockwise from behind.
Vec2 form_point(OutlineForm form, int i) {
  const double angle = std::numbers::pi + 2 * std::numbers::pi * i / Outline::k_control_points;
  const Vec2 round{std::cos(angle), std::sin(angle)};
  if (form == OutlineForm::Box)
    return 0.5 * (Vec2::Ones() + round / round.cwiseAbs().maxCoeff()) - Vec2{0, 0.5};
  if (form == OutlineForm::Oval) return {0.5 + 0.5 * round.x(), 0.5 * round.y()};
  // An iron's sole: broadest behind the middle, pointed in front.
  const double x = 0.5 + 0.5 * round.x();
  const double breadth = std::pow(std::max(1 - x, 0.0), 0.6) * std::min(1.0, 0.75 + 2 * x);
  return {x, 0.5 * breadth * (round.y() > 0 ? 1.0 : -1.0) * std::min(1.0, 3 * std::abs(round.y()))};
}

std::vector<Vec2> control_points(const OutlineShape& shape) {
  std::vector<Vec2> points;
  for (int i = 0; i < Outline::k_control_points; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double sideways = shape.width_ratio * (shape.jitter.empty() ? 1.0 : 1.0 + shape.jitter[at]);
    if (shape.form != OutlineForm::Foot) {
      const Vec2 point = form_point(shape.form, i);
      points.emplace_back(shape.length_mm * point.x(), shape.length_mm * point.y() * sideways);
      continue;
    }
    const auto [x, y] = k_right_foot[at];
    const double waist = 1 + (shape.waist_ratio - 1) * hump(x, 0.38, 0.3);
    const double toe = 1 + (shape.toe_ratio - 1) * hump(x, 0.95, 0.28);
    points.emplace_back(shape.length_mm * x, shape.length_mm * y * sideways * waist * toe);
  }
  if (shape.form != OutlineForm::Foot) return points;
  if (!shape.left_foot) return points;
  for (auto& point : points) point.y() = -point.y();
  std::reverse(points.begin() + 1, points.end());  // still anticlockwise, still from the heel
  return points;
}

}  // namespace

Outline::Outline(const OutlineShape& shape) : control_(control_points(shape)) {
  BITELINE_EXPECTS(shape.jitter.empty() || shape.jitter.size() == k_right_foot.size());
  const int steps = k_control_points * k_table_steps;
  // The spline runs inside its control polygon: scale and shift it so that heel and toe stand where they
  // should.
  double x_low_mm = 1e9, x_high_mm = -1e9;
  for (int i = 0; i < steps; ++i) {
    const double x = evaluate(static_cast<double>(i) / k_table_steps).value.x();
    x_low_mm = std::min(x_low_mm, x);
    x_high_mm = std::max(x_high_mm, x);
  }
  const double scale = shape.length_mm / (x_high_mm - x_low_mm);
  for (auto& point : control_) point = Vec2{(point.x() - x_low_mm) * scale, point.y() * scale};
  length_mm_ = shape.length_mm;

  arc_mm_.reserve(static_cast<std::size_t>(steps) + 1);
  arc_mm_.push_back(0);
  for (int i = 0; i < steps; ++i) {
    const double a = static_cast<double>(i) / k_table_steps, h = 1.0 / k_table_steps;
    // Simpson's rule on the speed.
    const double length_mm =
        h / 6 *
        (evaluate(a).first.norm() + 4 * evaluate(a + h / 2).first.norm() + evaluate(a + h).first.norm());
    arc_mm_.push_back(arc_mm_.back() + length_mm);
  }
  perimeter_mm_ = arc_mm_.back();
}

Outline::Derivatives Outline::evaluate(double parameter) const {
  const double floor = std::floor(parameter);
  const double t = parameter - floor;
  const auto index = [&](int k) {
    const int wrapped = (static_cast<int>(floor) + k + 4 * k_control_points) % k_control_points;
    return control_[static_cast<std::size_t>(wrapped)];
  };
  const Vec2 a = index(-1), b = index(0), c = index(1), d = index(2);
  const double q = 1 - t;
  return {.value = (q * q * q * a + (3 * t * t * t - 6 * t * t + 4) * b +
                    (-3 * t * t * t + 3 * t * t + 3 * t + 1) * c + t * t * t * d) /
                   6,
          .first = (-q * q * a + (3 * t * t - 4 * t) * b + (-3 * t * t + 2 * t + 1) * c + t * t * d) / 2,
          .second = q * a + (3 * t - 2) * b + (1 - 3 * t) * c + t * d};
}

Outline::Place Outline::at(double s_mm) const {
  const double wrapped_mm = s_mm - perimeter_mm_ * std::floor(s_mm / perimeter_mm_);
  const auto above = std::upper_bound(arc_mm_.begin() + 1, arc_mm_.end() - 1, wrapped_mm);
  const double low_mm = *(above - 1);
  const double part = (wrapped_mm - low_mm) / (*above - low_mm);
  const Derivatives d = evaluate((static_cast<double>(above - 1 - arc_mm_.begin()) + part) / k_table_steps);
  const double speed = d.first.norm();
  const Vec2 tangent = d.first / speed;
  const double cross = d.first.x() * d.second.y() - d.first.y() * d.second.x();
  return {.point = d.value,
          .tangent = tangent,
          .normal = {tangent.y(), -tangent.x()},
          .curvature_per_mm = cross / (speed * speed * speed)};
}

double Outline::way_mm(double from_mm, double to_mm) const {
  return std::remainder(to_mm - from_mm, perimeter_mm_);
}

}  // namespace biteline::sim
