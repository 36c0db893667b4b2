// SPDX-License-Identifier: MIT
#include "host/intake/capture/known_piece.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "host/geometry/fit.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::capture {
namespace {

/// Farther from a surface than this is not on it: three times a bad profile's scatter.
constexpr double k_near_mm = 0.3;
constexpr std::size_t k_least_points = 200;
/// Draws and judges by so many points; the fit itself takes all.
constexpr std::size_t k_trial_points = 4000;
constexpr int k_trials = 3000;
/// Another size is another piece.
constexpr double k_size_tolerance_ratio = 0.2;
constexpr int k_fit_rounds = 15;
constexpr double k_outlier_sigmas = 3;
const double k_parallel = std::cos(3 * std::numbers::pi / 180);

struct Sphere {
  Vec3 centre{Vec3::Zero()};
  double radius_mm{0};
  [[nodiscard]] double off_mm(const Vec3& point) const { return (point - centre).norm() - radius_mm; }
};

struct Plane {
  Vec3 normal{Vec3::UnitZ()};
  Vec3 mean{Vec3::Zero()};
  [[nodiscard]] double off_mm(const Vec3& point) const { return normal.dot(point - mean); }
};

std::vector<Vec3> thinned(std::span<const Vec3> points) {
  std::vector<Vec3> some;
  const std::size_t step = std::max<std::size_t>(1, points.size() / k_trial_points);
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

template <class Surface>
std::vector<Vec3> near_to(const Surface& surface, std::span<const Vec3> points, double within_mm) {
  std::vector<Vec3> near;
  for (const Vec3& point : points) {
    if (std::abs(surface.off_mm(point)) <= within_mm) near.push_back(point);
  }
  return near;
}

template <class Surface>
double rms_mm(const Surface& surface, std::span<const Vec3> points) {
  double sum = 0;
  for (const Vec3& point : points) sum += std::pow(surface.off_mm(point), 2);
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(points.size(), 1)));
}

std::optional<Sphere> sphere_through(const std::array<Vec3, 4>& p) {
  Mat3 A;
  Vec3 b;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &first = p[0], &other = p[static_cast<std::size_t>(i) + 1];
    A.row(i) = 2 * (other - first).transpose();
    b[i] = other.squaredNorm() - first.squaredNorm();
  }
  const Eigen::FullPivLU<Mat3> solver{A};
  if (!solver.isInvertible()) return std::nullopt;
  const Vec3 centre = solver.solve(b);
  return Sphere{centre, (p[0] - centre).norm()};
}

/// Draws until most of the points lie on what goes through some of them.
template <std::size_t Count, class Surface, class Through, class Plausible>
std::optional<Surface> find_most(std::span<const Vec3> points, const Through& through,
                                 const Plausible& plausible) {
  if (points.size() < k_least_points) return std::nullopt;
  const std::vector<Vec3> some = thinned(points);
  std::mt19937 random{1};  // the same scan gives the same answer
  std::uniform_int_distribution<std::size_t> any{0, some.size() - 1};
  std::optional<Surface> best;
  std::ptrdiff_t most = 0;
  for (int trial = 0; trial < k_trials; ++trial) {
    std::array<Vec3, Count> drawn;
    for (Vec3& point : drawn) point = some[any(random)];
    const std::optional<Surface> surface = through(drawn);
    if (!surface || !plausible(*surface)) continue;
    const std::ptrdiff_t count = std::ranges::count_if(
        some, [&](const Vec3& point) { return std::abs(surface->off_mm(point)) <= k_near_mm; });
    if (count <= most) continue;
    most = count;
    best = surface;
  }
  return best;
}

std::optional<Plane> plane_through(const std::array<Vec3, 3>& p) {
  const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
  constexpr double k_least_area_mm2 = 1;
  if (normal.norm() < k_least_area_mm2) return std::nullopt;
  return Plane{normal.normalized(), p[0]};
}

/// From the farthest below to the farthest above, without the 3 in 1000 that are farthest from the middle.
template <class Surface>
double range_mm(const Surface& surface, std::span<const Vec3> points) {
  constexpr double k_left_out_ratio = 0.003;
  std::vector<double> off;
  for (const Vec3& point : points) off.push_back(surface.off_mm(point));
  std::ranges::sort(off, {}, [](double value) { return std::abs(value); });
  off.resize(off.size() - static_cast<std::size_t>(k_left_out_ratio * static_cast<double>(off.size())));
  const auto [low, high] = std::ranges::minmax(off);
  return high - low;
}

/// Least squares over what lies near, strays left out.
std::optional<Plane> fitted(const Plane& start, std::span<const Vec3> points, std::vector<Vec3>& used) {
  Plane plane = start;
  double within_mm = k_near_mm;
  for (int round = 0; round < k_fit_rounds; ++round) {
    used = near_to(plane, points, within_mm);
    const auto fit = geometry::fit_plane(used);
    if (used.size() < k_least_points || !fit) return std::nullopt;
    plane = {fit->normal.dot(plane.normal) < 0 ? Vec3(-fit->normal) : fit->normal, fit->mean};
    within_mm = std::min(k_near_mm, std::max(k_outlier_sigmas * rms_mm(plane, used), 1e-6));
  }
  return plane;
}

/// Both faces have one direction; where they lie beside each other its error counts with the distance.
PieceSize common_step(std::span<const Vec3> low, std::span<const Vec3> high) {
  Mat3 scatter = Mat3::Zero();
  const auto add = [&](std::span<const Vec3> points) {
    Vec3 mean = Vec3::Zero();
    for (const Vec3& point : points) mean += point;
    mean /= static_cast<double>(points.size());
    for (const Vec3& point : points) scatter += (point - mean) * (point - mean).transpose();
    return mean;
  };
  const Vec3 apart = -add(low) + add(high);
  const geometry::PrincipalAxes axes = geometry::principal_axes(scatter);
  const double count = static_cast<double>(low.size() + high.size());
  const double variance_mm2 = axes.values[0] / count;
  double share = 1 / static_cast<double>(low.size()) + 1 / static_cast<double>(high.size());
  for (const int i : {1, 2}) share += std::pow(axes.vectors.col(i).dot(apart), 2) / axes.values[i];
  return {std::abs(axes.vectors.col(0).dot(apart)), std::sqrt(variance_mm2 * share), std::sqrt(variance_mm2),
          low.size() + high.size()};
}

}  // namespace

Result<BallFit> fit_ball(std::span<const Vec3> points, double diameter_mm, double form_within_mm) {
  const double wanted_mm = diameter_mm / 2;
  auto sphere = find_most<4, Sphere>(points, sphere_through, [&](const Sphere& s) {
    return std::abs(s.radius_mm - wanted_mm) <= k_size_tolerance_ratio * wanted_mm;
  });
  if (!sphere) return fail(Errc::Refused, "no ball of about %.3f mm is in the scan", diameter_mm);
  std::vector<Vec3> used;
  Eigen::Matrix4d normal_matrix = Eigen::Matrix4d::Identity();
  double within_mm = k_near_mm;
  for (int round = 0; round < k_fit_rounds; ++round) {
    used = near_to(*sphere, points, within_mm);
    if (used.size() < k_least_points)
      return fail(Errc::Refused, "only %zu points lie on the ball of %.3f mm", used.size(), diameter_mm);
    normal_matrix.setZero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (const Vec3& point : used) {
      Eigen::Vector4d row;
      row << -(point - sphere->centre).normalized(), -1;
      normal_matrix += row * row.transpose();
      right -= row * sphere->off_mm(point);
    }
    const Eigen::Vector4d step = geometry::solve_symmetric(normal_matrix, right);
    sphere->centre += step.head<3>();
    sphere->radius_mm += step[3];
    within_mm = std::min(k_near_mm, std::max(k_outlier_sigmas * rms_mm(*sphere, used), 1e-6));
  }
  const double scatter_mm = rms_mm(*sphere, used);
  const double radius_variance = geometry::SymmetricSolver{normal_matrix}.inverse()(3, 3);
  const double sigma_mm = 2 * scatter_mm * std::sqrt(std::max(0.0, radius_variance));
  constexpr double k_most_sigma_ratio = 0.005;
  if (!(sigma_mm <= k_most_sigma_ratio * diameter_mm) ||
      std::abs(2 * sphere->radius_mm / diameter_mm - 1) > k_size_tolerance_ratio)
    return fail(Errc::Refused, "too small a part of the ball of %.3f mm is in the scan", diameter_mm);
  BallFit ball{.centre = sphere->centre, .size = {2 * sphere->radius_mm, sigma_mm, scatter_mm, used.size()}};
  ball.form_mm = range_mm(*sphere, near_to(*sphere, points, form_within_mm));
  return ball;
}

Result<PieceSize> measure_ball(std::span<const Vec3> points, double diameter_mm) {
  BITELINE_ASSIGN(const BallFit ball, fit_ball(points, diameter_mm, k_near_mm));
  return ball.size;
}

Result<BarFit> measure_bar(std::span<const Vec3> points, const Bar& bar) {
  BITELINE_ASSIGN(const BallFit first, fit_ball(points, bar.diameter_mm, k_near_mm));
  std::vector<Vec3> rest;
  const double beyond_mm = bar.diameter_mm / 2 + 2 * k_near_mm;
  for (const Vec3& point : points) {
    if ((point - first.centre).norm() > beyond_mm) rest.push_back(point);
  }
  const Result<BallFit> second = fit_ball(rest, bar.diameter_mm, k_near_mm);
  if (!second)
    return fail(Errc::Refused, "only one ball of %.3f mm is in the scan, the bar has two", bar.diameter_mm);
  const double distance_mm = (second->centre - first.centre).norm();
  if (std::abs(distance_mm / bar.distance_mm - 1) > k_size_tolerance_ratio)
    return fail(Errc::Refused, "balls %.3f mm apart are in the scan, and no bar of %.3f mm", distance_mm,
                bar.distance_mm);
  // A middle is known no worse than its ball's size.
  return BarFit{.distance_mm = distance_mm,
                .sigma_mm = std::hypot(first.size.sigma_mm, second->size.sigma_mm) / 2,
                .points = first.size.points + second->size.points};
}

Result<FlatFit> measure_flat(std::span<const Vec3> points, double within_mm) {
  auto plane = find_most<3, Plane>(points, plane_through, [](const Plane&) { return true; });
  std::vector<Vec3> used;
  for (int round = 0; plane && round < k_fit_rounds; ++round) {
    used = near_to(*plane, points, within_mm);
    const auto fit = geometry::fit_plane(used);
    if (!fit || used.size() < k_least_points) return fail(Errc::Refused, "no plane is in the scan");
    plane = Plane{fit->normal, fit->mean};
  }
  if (!plane) return fail(Errc::Refused, "no plane is in the scan");
  used = near_to(*plane, points, within_mm);
  Mat3 scatter = Mat3::Zero();
  for (const Vec3& point : used) scatter += (point - plane->mean) * (point - plane->mean).transpose();
  const Vec3 along = geometry::principal_axes(scatter).vectors.col(2);
  const auto [first, last] =
      std::ranges::minmax(used, {}, [&](const Vec3& point) { return along.dot(point); });
  return FlatFit{.flatness_mm = range_mm(*plane, used),
                 .rms_mm = rms_mm(*plane, used),
                 .across_mm = along.dot(last - first),
                 .points = used.size()};
}

Result<PieceSize> measure_step(std::span<const Vec3> points, double height_mm) {
  const auto any = [](const Plane&) { return true; };
  const auto first = find_most<3, Plane>(points, plane_through, any);
  std::vector<Vec3> low, high;
  const auto low_plane = first ? fitted(*first, points, low) : std::nullopt;
  if (!low_plane) return fail(Errc::Refused, "no plane is in the scan");
  std::vector<Vec3> rest;
  for (const Vec3& point : points) {
    if (std::abs(low_plane->off_mm(point)) > k_near_mm) rest.push_back(point);
  }
  const auto second = find_most<3, Plane>(rest, plane_through, [&](const Plane& plane) {
    return std::abs(plane.normal.dot(low_plane->normal)) > k_parallel &&
           std::abs(std::abs(low_plane->off_mm(plane.mean)) / height_mm - 1) <= k_size_tolerance_ratio;
  });
  const auto high_plane = second ? fitted(*second, rest, high) : std::nullopt;
  if (!high_plane) return fail(Errc::Refused, "no step of about %.3f mm is in the scan", height_mm);
  return common_step(low, high);
}

}  // namespace biteline::capture
