// SPDX-License-Identifier: MIT
#include "host/calibration/chess/corners.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

/// Smooths away the noise and keeps squares of 12 px apart.
constexpr double k_smoothing_px = 1.5;
constexpr std::size_t k_least_square_px = 12;
/// Of the smoothed grey's second derivatives: half of what a contrast of 8 grey levels has behind a lens of
/// 2 px, and 70 times what noise of 2 grey levels has.
constexpr float k_least_saddle = 0.5F;
/// The circle on which a corner shows two dark and two bright arcs, and the picture of one beside it does
/// not.
constexpr int k_circle_px = 5, k_circle_samples = 40;
constexpr double k_least_swing_grey = 12;
/// Arcs of opposite squares are equal but for perspective over some pixels, noise and blur.
constexpr double k_opposite_rad = 0.4;
/// Edges that cross at less are of no board that can be measured.
constexpr double k_least_crossing_rad = 0.3;
/// What is not told by the corner: noise, dirt, grain of the print.
constexpr double k_most_rms_ratio = 0.2;

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

float grey_at(const cv::Mat& picture, double u, double v) {
  const double u0 = std::floor(u), v0 = std::floor(v);
  const auto du = static_cast<float>(u - u0), dv = static_cast<float>(v - v0);
  const float* upper = picture.ptr<float>(static_cast<int>(v0)) + static_cast<int>(u0);
  const float* lower = picture.ptr<float>(static_cast<int>(v0) + 1) + static_cast<int>(u0);
  return (1 - dv) * ((1 - du) * upper[0] + du * upper[1]) + dv * ((1 - du) * lower[0] + du * lower[1]);
}

Vec2 towards(double angle_rad) {
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

/// Two dark and two bright arcs about a place; their borders are the edges.
std::optional<Corner> corner_on_circle(const cv::Mat& smooth, int u, int v) {
  std::array<double, k_circle_samples> greys{};
  constexpr double k_step_rad = 2 * std::numbers::pi / k_circle_samples;
  for (int i = 0; i < k_circle_samples; ++i) {
    const Vec2 at = Vec2(u, v) + k_circle_px * towards(i * k_step_rad);
    greys[static_cast<std::size_t>(i)] = grey_at(smooth, at.x(), at.y());
  }
  const auto [least, most] = std::minmax_element(greys.begin(), greys.end());
  if (*most - *least < k_least_swing_grey) return std::nullopt;
  const double middle = (*most + *least) / 2;
  std::array<double, 4> borders_rad{};
  std::size_t count = 0;
  bool bright_after_first = false;
  for (std::size_t i = 0; i < greys.size(); ++i) {
    const double here = greys[i] - middle, next = greys[(i + 1) % greys.size()] - middle;
    if ((here > 0) == (next > 0)) continue;
    if (count == borders_rad.size()) return std::nullopt;
    if (count == 0) bright_after_first = next > 0;
    borders_rad[count++] = (static_cast<double>(i) + here / (here - next)) * k_step_rad;
  }
  if (count != borders_rad.size()) return std::nullopt;
  const double off_a = borders_rad[2] - borders_rad[0] - std::numbers::pi,
               off_b = borders_rad[3] - borders_rad[1] - std::numbers::pi;
  if (std::abs(off_a) > k_opposite_rad || std::abs(off_b) > k_opposite_rad) return std::nullopt;
  return Corner{.place_px = Vec2(u, v),
                .edge_a = towards(borders_rad[0] + off_a / 2),
                .edge_b = towards(borders_rad[1] + off_b / 2),
                .mean_grey = middle,
                .contrast = (bright_after_first ? 1 : -1) * (*most - *least) / 2,
                .blur_a_px = k_smoothing_px,
                .blur_b_px = k_smoothing_px};
}

/// Of one scale, in its own pixels.
std::vector<Corner> rough_corners(const cv::Mat& grey) {
  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, cv::Size(), k_smoothing_px, k_smoothing_px, cv::BORDER_REPLICATE);
  cv::Mat saddle(smooth.size(), CV_32F, cv::Scalar(0));
  for (int v = 1; v + 1 < smooth.rows; ++v) {
    const float *above = smooth.ptr<float>(v - 1), *at = smooth.ptr<float>(v),
                *below = smooth.ptr<float>(v + 1);
    auto* out = saddle.ptr<float>(v);
    for (int u = 1; u + 1 < smooth.cols; ++u) {
      const float uu = at[u - 1] - 2 * at[u] + at[u + 1], vv = above[u] - 2 * at[u] + below[u],
                  uv = (above[u - 1] - above[u + 1] - below[u - 1] + below[u + 1]) / 4;
      out[u] = uv * uv - uu * vv;
    }
  }
  cv::Mat highest;
  cv::dilate(saddle, highest, cv::Mat::ones(5, 5, CV_8U));
  std::vector<Corner> corners;
  const int border = k_circle_px + 2;
  for (int v = border; v + border < smooth.rows; ++v) {
    const auto *out = saddle.ptr<float>(v), *top = highest.ptr<float>(v);
    for (int u = border; u + border < smooth.cols; ++u) {
      if (out[u] < k_least_saddle || out[u] < top[u]) continue;
      if (const auto corner = corner_on_circle(smooth, u, v)) corners.push_back(*corner);
    }
  }
  return corners;
}

constexpr int k_corner_unknowns = 10;
using CornerVector = Eigen::Matrix<double, k_corner_unknowns, 1>;
using CornerMatrix = Eigen::Matrix<double, k_corner_unknowns, k_corner_unknowns>;

/// One edge at a pixel: -1 on one side, 1 on the other, blurred between.
struct EdgeStep {
  double level{0}, slope_per_px{0};
  EdgeStep(double distance_px, double blur_px) {
    const double ratio = distance_px / blur_px;
    if (std::abs(ratio) > 6) {  // flat to a billionth; and exp() would underflow farther out
      level = ratio > 0 ? 1 : -1;
      return;
    }
    level = std::erf(ratio / std::numbers::sqrt2);
    slope_per_px = std::sqrt(2 / std::numbers::pi) / blur_px * std::exp(-ratio * ratio / 2);
  }
};

/// Sharper than what a pixel's own extent blurs, 0.29 px, there is nothing.
constexpr double k_least_blur_px = 0.25;

struct CornerEquations {
  CornerMatrix information{CornerMatrix::Zero()};  ///< upper half
  CornerVector gradient{CornerVector::Zero()};
  double sum{0};  ///< of squared residuals
  int pixels{0};
};

/// Unknowns in order: place (2), angle of a, of b, mean, contrast, blur of a, of b, light's slope (2, per
/// px).
struct CornerModel {
  CornerVector x;

  /// Grey at a pixel, and its derivatives.
  double grey(double u, double v, CornerVector& J) const {
    const Vec2 q(u - x[0], v - x[1]), a = towards(x[2]), b = towards(x[3]);
    const double off_a = cross(a, q), off_b = -cross(b, q);
    const EdgeStep step_a(off_a, x[6]), step_b(off_b, x[7]);
    const double light = 1 + x[8] * q.x() + x[9] * q.y();
    const double print = x[4] + x[5] * step_a.level * step_b.level;
    const double by_a = light * x[5] * step_a.slope_per_px * step_b.level,
                 by_b = light * x[5] * step_b.slope_per_px * step_a.level;
    J << by_a * a.y() - by_b * b.y() - x[8] * print, -by_a * a.x() + by_b * b.x() - x[9] * print,
        -by_a * a.dot(q), by_b * b.dot(q), light, light * step_a.level * step_b.level, -by_a * off_a / x[6],
        -by_b * off_b / x[7], print * q.x(), print * q.y();
    return light * print;
  }
};

}  // namespace

bool Corner::bright_towards(const Vec2& direction) const {
  const bool between = (cross(edge_a, direction) > 0) == (cross(direction, edge_b) > 0);
  return between == (contrast > 0);
}

std::optional<Corner> refine_corner(const image::GreyImage& picture, const Corner& near, double radius_px,
                                    double reach_px) {
  CornerModel model;
  model.x << near.place_px, std::atan2(near.edge_a.y(), near.edge_a.x()),
      std::atan2(near.edge_b.y(), near.edge_b.x()), near.mean_grey, near.contrast, near.blur_a_px,
      near.blur_b_px, 0, 0;
  // The window stays where it is, so that each step's pixels are the same.
  const int left = static_cast<int>(std::ceil(near.place_px.x() - radius_px)),
            right = static_cast<int>(std::floor(near.place_px.x() + radius_px)),
            top = static_cast<int>(std::ceil(near.place_px.y() - radius_px)),
            bottom = static_cast<int>(std::floor(near.place_px.y() + radius_px));
  if (left < 0 || top < 0 || right >= picture.width_px || bottom >= picture.height_px) return std::nullopt;
  const auto equations_of = [&](const CornerModel& at) {
    CornerEquations equations;
    for (int v = top; v <= bottom; ++v) {
      for (int u = left; u <= right; ++u) {
        if ((Vec2(u, v) - near.place_px).squaredNorm() > radius_px * radius_px) continue;
        CornerVector J;
        const double residual = picture.at(u, v) - at.grey(u, v, J);
        equations.information.selfadjointView<Eigen::Upper>().rankUpdate(J);
        equations.gradient += J * residual;
        equations.sum += residual * residual;
        ++equations.pixels;
      }
    }
    return equations;
  };
  // Levenberg and Marquardt: a step that makes it worse is taken again, shorter.
  constexpr int k_most_rounds = 25;
  constexpr double k_settled_ratio = 1e-8, k_most_damping = 1e6;
  CornerEquations now = equations_of(model);
  double damping = 1e-3;
  for (int round = 0; round < k_most_rounds && damping < k_most_damping; ++round) {
    CornerMatrix damped = now.information.selfadjointView<Eigen::Upper>();
    damped.diagonal() *= 1 + damping;
    const CornerVector step = geometry::solve_symmetric(damped, now.gradient);
    if (!step.allFinite()) return std::nullopt;
    CornerModel next{model.x + step};
    for (const int blur : {6, 7}) next.x[blur] = std::clamp(next.x[blur], k_least_blur_px, radius_px);
    CornerEquations then = equations_of(next);
    if (then.sum > now.sum) {
      damping *= 10;
      continue;
    }
    const bool settled = now.sum - then.sum <= k_settled_ratio * now.sum;
    model = next;
    now = then;
    damping = std::max(1e-9, damping / 10);
    if (settled) break;
  }
  const CornerVector& x = model.x;
  if (!x.allFinite() || (x.head<2>() - near.place_px).norm() > reach_px) return std::nullopt;
  if (std::abs(x[5]) < k_least_swing_grey / 2 ||
      std::sqrt(now.sum / std::max(1, now.pixels)) > k_most_rms_ratio * std::abs(x[5]))
    return std::nullopt;
  Corner corner{.place_px = x.head<2>(),
                .edge_a = towards(x[2]),
                .edge_b = towards(x[3]),
                .mean_grey = x[4],
                .contrast = x[5],
                .blur_a_px = x[6],
                .blur_b_px = x[7]};
  if (cross(corner.edge_a, corner.edge_b) < std::sin(k_least_crossing_rad)) return std::nullopt;
  return corner;
}

std::vector<Corner> find_corners(const image::GreyImage& picture) {
  if (picture.width_px < 4 * k_circle_px || picture.height_px < 4 * k_circle_px) return {};
  cv::Mat grey(picture.height_px, picture.width_px, CV_8U, const_cast<std::uint8_t*>(picture.pixels.data()));
  std::vector<Corner> corners;
  for (const int scale : {1, 2, 4}) {
    cv::Mat scaled;
    grey.convertTo(scaled, CV_32F);
    if (scale > 1) cv::resize(scaled, scaled, cv::Size(), 1.0 / scale, 1.0 / scale, cv::INTER_AREA);
    std::vector<Corner> roughs = rough_corners(scaled);
    // More corners than the smallest squares could have: noise, or a pattern of single pixels.
    if (roughs.size() * k_least_square_px * k_least_square_px > scaled.total()) continue;
    for (Corner& rough : roughs) {
      rough.place_px = ((rough.place_px.array() + 0.5) * scale - 0.5).matrix();
      rough.blur_a_px = rough.blur_b_px = scale;
      const bool known = std::any_of(corners.begin(), corners.end(), [&](const Corner& corner) {
        return (corner.place_px - rough.place_px).norm() < 3 * scale;
      });
      if (known) continue;
      if (const auto corner = refine_corner(picture, rough, (k_circle_px + 1) * scale, 2.0 * scale + 1))
        corners.push_back(*corner);
    }
  }
  return corners;
}

}  // namespace biteline::calibration
