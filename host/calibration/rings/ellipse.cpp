// SPDX-License-Identifier: MIT
#include "host/calibration/rings/ellipse.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "host/geometry/robust.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

/// Coordinates shifted and scaled to about unit size: the fits' normal equations lose their digits otherwise.
struct Normaliser {
  Vec2 shift{Vec2::Zero()};
  double scale{1};

  explicit Normaliser(std::span<const Vec2> points) {
    for (const Vec2& point : points) shift += point;
    shift /= static_cast<double>(points.size());
    double sum = 0;
    for (const Vec2& point : points) sum += (point - shift).norm();
    scale = sum / static_cast<double>(points.size());
  }
  [[nodiscard]] Vec2 apply(const Vec2& point) const { return (point - shift) / scale; }
  [[nodiscard]] Ellipse undo(Ellipse ellipse) const {
    ellipse.centre = ellipse.centre * scale + shift;
    ellipse.major_semi *= scale;
    ellipse.minor_semi *= scale;
    return ellipse;
  }
};

/// Halir and Flusser 1998, "Numerically stable direct least squares fitting of ellipses", section 3.
std::optional<Ellipse> fit_directly(std::span<const Vec2> points) {
  Mat3 S1 = Mat3::Zero(), S2 = Mat3::Zero(), S3 = Mat3::Zero();
  for (const Vec2& p : points) {
    const Vec3 quadratic(p.x() * p.x(), p.x() * p.y(), p.y() * p.y());
    const Vec3 linear(p.x(), p.y(), 1);
    S1 += quadratic * quadratic.transpose();
    S2 += quadratic * linear.transpose();
    S3 += linear * linear.transpose();
  }
  const Mat3 T = -S3.ldlt().solve(S2.transpose());
  const Mat3 reduced = S1 + S2 * T;
  Mat3 M;  // inverse of the constraint matrix of 4 a c - b^2 = 1, times the reduced scatter
  M.row(0) = reduced.row(2) / 2;
  M.row(1) = -reduced.row(1);
  M.row(2) = reduced.row(0) / 2;
  const Eigen::EigenSolver<Mat3> solver(M);
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = solver.eigenvectors().col(i).real();
    if (4 * a[0] * a[2] - a[1] * a[1] <= 0) continue;
    const Vec3 b = T * a;
    Mat3 conic;
    conic << a[0], a[1] / 2, b[0] / 2, a[1] / 2, a[2], b[1] / 2, b[0] / 2, b[1] / 2, b[2];
    return Ellipse::from_conic(conic);
  }
  return std::nullopt;
}

Ellipse from_parameters(const Eigen::Matrix<double, 5, 1>& p) {
  Ellipse ellipse{.centre = p.head<2>(), .major_semi = p[2], .minor_semi = p[3], .angle_rad = p[4]};
  if (ellipse.major_semi < ellipse.minor_semi) {
    std::swap(ellipse.major_semi, ellipse.minor_semi);
    ellipse.angle_rad += std::numbers::pi / 2;
  }
  return ellipse;
}

/// Gauss-Newton on the first-order distances; the algebraic fit is pulled towards small ellipses when points
/// are missing.
Ellipse refine(Ellipse ellipse, std::span<const Vec2> points) {
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 1> gradient = Eigen::Matrix<double, 5, 1>::Zero();
    const double c = std::cos(ellipse.angle_rad), s = std::sin(ellipse.angle_rad);
    const double a = ellipse.major_semi, b = ellipse.minor_semi;
    for (const Vec2& point : points) {
      const Vec2 d = point - ellipse.centre;
      const double x = c * d.x() + s * d.y(), y = -s * d.x() + c * d.y();
      const double rho = std::hypot(x / a, y / b);
      if (rho < 1e-9) continue;
      // distance = (rho - 1) rho / |grad of rho^2 / 2|, see Ellipse::distance().
      const double gx = x / (a * a), gy = y / (b * b);
      const double slope = std::hypot(gx, gy) / rho;
      const double residual = (rho - 1) / slope;
      // On the curve the distance changes with the parameters as rho does, over the slope; off it, to first
      // order.
      Eigen::Matrix<double, 5, 1> J;
      J[0] = -(gx * c - gy * s) / rho / slope;
      J[1] = -(gx * s + gy * c) / rho / slope;
      J[2] = -x * x / (a * a * a) / rho / slope;
      J[3] = -y * y / (b * b * b) / rho / slope;
      J[4] = (gx * y - gy * x) / rho / slope;
      information += J * J.transpose();
      gradient += J * residual;
    }
    information(4, 4) += 1e-9 * information.trace();  // a circle has no angle
    const Eigen::Matrix<double, 5, 1> step = geometry::solve_symmetric(information, gradient);
    Eigen::Matrix<double, 5, 1> next;
    next << ellipse.centre, a, b, ellipse.angle_rad;
    next -= step;
    if (!next.allFinite() || next[2] <= 0.2 * a || next[3] <= 0.2 * b || step.head<2>().norm() > a) break;
    ellipse = from_parameters(next);
    if (step.norm() < 1e-10 * a) break;
  }
  return ellipse;
}

/// Share of 36 sectors of 10 degrees that hold a kept point.
double coverage(const Ellipse& ellipse, std::span<const Vec2> points, const std::vector<char>& kept) {
  std::array<bool, 36> seen{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!kept[i]) continue;
    const Vec2 d = Eigen::Rotation2Dd(-ellipse.angle_rad) * (points[i] - ellipse.centre);
    const double phase_rad =
        std::atan2(d.y() / ellipse.minor_semi, d.x() / ellipse.major_semi) + std::numbers::pi;
    seen[static_cast<std::size_t>(phase_rad / (2 * std::numbers::pi) * 35.999)] = true;
  }
  return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / 36.0;
}

}  // namespace

Vec2 Ellipse::at(double phase_rad) const {
  return centre + Eigen::Rotation2Dd(angle_rad) *
                      Vec2(major_semi * std::cos(phase_rad), minor_semi * std::sin(phase_rad));
}

Vec2 Ellipse::normal_at(double phase_rad) const {
  return (Eigen::Rotation2Dd(angle_rad) *
          Vec2(std::cos(phase_rad) / major_semi, std::sin(phase_rad) / minor_semi))
      .normalized();
}

double Ellipse::distance(const Vec2& point) const {
  const Vec2 d = Eigen::Rotation2Dd(-angle_rad) * (point - centre);
  const double rho = std::hypot(d.x() / major_semi, d.y() / minor_semi);
  if (rho < 1e-9) return -minor_semi;
  const double slope = std::hypot(d.x() / (major_semi * major_semi), d.y() / (minor_semi * minor_semi)) / rho;
  return (rho - 1) / slope;
}

Mat3 Ellipse::conic() const {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Mat3 T;  // image -> the ellipse's own axes
  T << c, s, -c * centre.x() - s * centre.y(), -s, c, s * centre.x() - c * centre.y(), 0, 0, 1;
  return T.transpose() * Vec3(1 / (major_semi * major_semi), 1 / (minor_semi * minor_semi), -1).asDiagonal() *
         T;
}

std::optional<Ellipse> Ellipse::from_conic(const Mat3& conic) {
  const Eigen::Matrix2d A = conic.topLeftCorner<2, 2>();
  if (!(A.determinant() > 0)) return std::nullopt;
  const double sign = A.trace() > 0 ? 1.0 : -1.0;
  const Vec2 centre = -A.inverse() * conic.topRightCorner<2, 1>();
  const double level = -sign * (conic(2, 2) + conic.topRightCorner<2, 1>().dot(centre));
  if (!(level > 0)) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(sign * A);
  if (!(axes.eigenvalues()[0] > 0)) return std::nullopt;
  const Vec2 major = axes.eigenvectors().col(0);
  return Ellipse{.centre = centre,
                 .major_semi = std::sqrt(level / axes.eigenvalues()[0]),
                 .minor_semi = std::sqrt(level / axes.eigenvalues()[1]),
                 .angle_rad = std::atan2(major.y(), major.x())};
}

std::optional<Ellipse> fit_ellipse(std::span<const Vec2> points) {
  if (points.size() < 6) return std::nullopt;
  const Normaliser normaliser(points);
  if (!(normaliser.scale > 0)) return std::nullopt;
  std::vector<Vec2> scaled(points.size());
  std::transform(points.begin(), points.end(), scaled.begin(),
                 [&](const Vec2& p) { return normaliser.apply(p); });
  const std::optional<Ellipse> direct = fit_directly(scaled);
  // An axis ratio of 30 is a plane seen within 2 degrees of its edge, or points on a line.
  if (!direct || direct->major_semi > 30 * direct->minor_semi || direct->major_semi > 100)
    return std::nullopt;
  return normaliser.undo(refine(*direct, scaled));
}

std::optional<RobustEllipse> fit_ellipse_robustly(std::span<const Vec2> points, double floor) {
  RobustEllipse result{
      .ellipse = {}, .kept = std::vector<char>(points.size(), 1), .rms = 0, .coverage_ratio = 0};
  std::vector<Vec2> used(points.begin(), points.end());
  for (int round = 0; round < 10; ++round) {
    const std::optional<Ellipse> ellipse = fit_ellipse(used);
    if (!ellipse) return std::nullopt;
    result.ellipse = *ellipse;
    std::vector<double> distances(points.size());
    std::transform(points.begin(), points.end(), distances.begin(),
                   [&](const Vec2& p) { return std::abs(result.ellipse.distance(p)); });
    const double limit = std::max(floor, 3 * geometry::k_sigma_per_mad * geometry::median_of(distances));
    std::vector<char> kept(points.size());
    used.clear();
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      kept[i] = distances[i] <= limit;
      if (!kept[i]) continue;
      used.push_back(points[i]);
      sum += distances[i] * distances[i];
    }
    if (used.size() < 6) return std::nullopt;
    result.rms = std::sqrt(sum / static_cast<double>(used.size()));
    const bool settled = kept == result.kept;
    result.kept = std::move(kept);
    if (settled) break;
  }
  result.coverage_ratio = coverage(result.ellipse, points, result.kept);
  return result;
}

std::optional<ConcentricCentre> concentric_centre(const Ellipse& outer, const Ellipse& inner) {
  // In coordinates where the outer ellipse is about the unit circle the eigenvalues are of one size.
  Mat3 T = Mat3::Identity();
  T(0, 0) = T(1, 1) = outer.major_semi;
  T.topRightCorner<2, 1>() = outer.centre;
  const Mat3 C_outer = T.transpose() * outer.conic() * T, C_inner = T.transpose() * inner.conic() * T;
  const Eigen::EigenSolver<Mat3> solver(C_outer.inverse() * C_inner);
  const Vec3 values = solver.eigenvalues().real();
  // Noise splits the double eigenvalue, in a complex pair maybe; the third is the one farther from the
  // others.
  int single = 0;
  double farthest = -1;
  for (int i = 0; i < 3; ++i) {
    const double gap = std::min(std::abs(std::log(std::abs(values[i] / values[(i + 1) % 3]))),
                                std::abs(std::log(std::abs(values[i] / values[(i + 2) % 3]))));
    if (gap > farthest) {
      farthest = gap;
      single = i;
    }
  }
  const Vec3 v = solver.eigenvectors().col(single).real();
  if (std::abs(v[2]) < 1e-6 * v.norm()) return std::nullopt;
  const double pair = (values[(single + 1) % 3] + values[(single + 2) % 3]) / 2;
  const double ratio = values[single] / pair;
  if (!(ratio > 0)) return std::nullopt;
  const Vec2 centre = (T * (v / v[2])).head<2>();
  if (outer.distance(centre) > 0) return std::nullopt;
  return ConcentricCentre{.centre = centre, .diameter_ratio = std::sqrt(ratio)};
}

std::optional<Ellipse> project_circle(const Mat3& H, const Vec2& centre_mm, double radius_mm) {
  const Mat3 H_inverse = H.inverse();
  const Mat3 circle =
      Ellipse{.centre = centre_mm, .major_semi = radius_mm, .minor_semi = radius_mm, .angle_rad = 0}.conic();
  return Ellipse::from_conic(H_inverse.transpose() * circle * H_inverse);
}

}  // namespace biteline::calibration
