// SPDX-License-Identifier: MIT
#include "host/calibration/drift/table_seen.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/calibration/drift/motion.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::drift {
namespace {

/// Feet of walls and dirt are farther off the table.
constexpr double k_on_table_mm = 0.4;
/// A table's stretch in one profile is so wide; the edge under a sole is not.
constexpr double k_least_width_mm = 2;
constexpr std::size_t k_least_points = 4, k_most_points = 12;
/// It lies all round a shoe.
constexpr double k_least_round_mm = 60;
constexpr double k_most_slope = 0.18;  // 10 degrees
/// A fixture of another height is another table.
constexpr double k_another_mm = 2;

struct Stretch {
  std::uint32_t frame{0};
  std::vector<std::size_t> points{};
};

/// Points of each frame, in scan order.
std::vector<Stretch> profiles_of(const ScanView& scan) {
  const std::vector<std::uint32_t> frames = frames_of(scan);
  std::vector<Stretch> profiles;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i] == k_no_frame) continue;
    if (profiles.empty() || profiles.back().frame != frames[i])
      profiles.push_back({.frame = frames[i], .points = {}});
    profiles.back().points.push_back(i);
  }
  std::erase_if(profiles, [](const Stretch& p) { return p.points.size() < 2 * k_least_points; });
  return profiles;
}

/// Least squares through points; nothing where they lie on a line.
std::optional<TablePlane> plane_through(const std::vector<Vec3>& points, const std::vector<double>& weights) {
  double weight = 0;
  Vec3 middle = Vec3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    weight += weights[i];
    middle += weights[i] * points[i];
  }
  if (!(weight > 0)) return std::nullopt;
  middle /= weight;
  Mat3 spread = Mat3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 d = points[i] - middle;
    spread += weights[i] * d * d.transpose();
  }
  const Eigen::Matrix2d level = spread.topLeftCorner<2, 2>();
  if (!(level.determinant() > 1e-6 * level.squaredNorm())) return std::nullopt;
  const Vec2 slope = level.inverse() * spread.topRightCorner<2, 1>();
  return TablePlane{
      .middle = middle.head<2>(), .height_mm = middle.z(), .slope_x = slope.x(), .slope_y = slope.y()};
}

/// The level plane that most profiles stand on with their lowest points.
std::optional<TablePlane> lowest_plane(const ScanView& scan, const std::vector<Stretch>& profiles) {
  std::vector<Vec3> feet;
  for (const Stretch& profile : profiles) {
    std::vector<Vec3> points;
    for (const std::size_t i : profile.points) points.push_back(scan.points_base[i].cast<double>());
    const auto low = points.begin() + k_least_points / 2;
    std::nth_element(points.begin(), low, points.end(),
                     [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
    feet.push_back(*low);
  }
  constexpr std::size_t k_trials = 60;
  constexpr double k_foot_mm = 1;
  const std::size_t third = feet.size() / 3, step = std::max<std::size_t>(1, third / k_trials);
  std::optional<TablePlane> best;
  std::size_t most = feet.size() / 2;
  for (std::size_t i = 0; i < third; i += step) {
    const auto plane = plane_through({feet[i], feet[i + third], feet[i + 2 * third]}, {1, 1, 1});
    if (!plane || std::hypot(plane->slope_x, plane->slope_y) > k_most_slope) continue;
    const auto on = static_cast<std::size_t>(std::ranges::count_if(
        feet, [&](const Vec3& foot) { return std::abs(plane->above_mm(foot)) < k_foot_mm; }));
    if (on <= most) continue;
    most = on;
    best = plane;
  }
  return best;
}

/// The part of each profile that lies on the plane.
std::vector<Stretch> stretches_on(const TablePlane& plane, const ScanView& scan,
                                  const std::vector<Stretch>& profiles) {
  std::vector<Stretch> found;
  for (const Stretch& profile : profiles) {
    Stretch on{.frame = profile.frame, .points = {}};
    for (const std::size_t i : profile.points) {
      if (std::abs(plane.above_mm(scan.points_base[i].cast<double>())) < k_on_table_mm)
        on.points.push_back(i);
    }
    if (on.points.size() < k_least_points) continue;
    const Vec2 across =
        (scan.points_base[on.points.back()] - scan.points_base[on.points.front()]).head<2>().cast<double>();
    if (across.norm() >= k_least_width_mm) found.push_back(std::move(on));
  }
  return found;
}

bool goes_round(const ScanView& scan, const std::vector<Stretch>& stretches) {
  Vec2 low = Vec2::Constant(1e9), high = Vec2::Constant(-1e9);
  for (const Stretch& stretch : stretches) {
    const Vec2 p = scan.points_base[stretch.points.front()].head<2>().cast<double>();
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).minCoeff() >= k_least_round_mm;
}

/// What lies off by more is no table.
double weight_of(double above_mm) {
  const double ratio = above_mm / k_on_table_mm;
  return std::abs(ratio) < 1 ? std::pow(1 - ratio * ratio, 2) : 0;
}

std::optional<TablePlane> fitted(const ScanView& scan, const std::vector<Stretch>& stretches,
                                 TablePlane plane) {
  std::vector<Vec3> points;
  for (const Stretch& stretch : stretches)
    for (const std::size_t i : stretch.points) points.push_back(scan.points_base[i].cast<double>());
  for (int round = 0; round < 3; ++round) {
    std::vector<double> weights;
    for (const Vec3& point : points) weights.push_back(weight_of(plane.above_mm(point)));
    const auto next = plane_through(points, weights);
    if (!next) return std::nullopt;
    plane = *next;
  }
  return plane;
}

/// Of a profile's middle against its neighbours': what an arm bends by over the way round is the usual.
double scatter_of(const ScanView& scan, const std::vector<Stretch>& stretches, const TablePlane& plane) {
  std::vector<double> steps_mm;
  double last_mm = 0;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    double sum = 0;
    for (const std::size_t i : stretches[k].points) sum += plane.above_mm(scan.points_base[i].cast<double>());
    const double middle_mm = sum / static_cast<double>(stretches[k].points.size());
    if (k > 0 && stretches[k].frame == stretches[k - 1].frame + 1)
      steps_mm.push_back(std::abs(middle_mm - last_mm));
    last_mm = middle_mm;
  }
  constexpr double k_least_mm = 0.005;
  if (steps_mm.empty()) return k_on_table_mm;
  return std::max(k_least_mm,
                  geometry::k_sigma_per_mad * geometry::median_of(std::move(steps_mm)) / std::numbers::sqrt2);
}

}  // namespace

TableEvidence TableEvidence::counted_from(const TablePlane& usual) const {
  // The table's columns at the usual one's middle.
  constexpr double k_height_mm = k_table[k_table_at].si, k_slope = k_table[k_table_at + 1].si;
  const Vec2 shift = plane.middle - usual.middle;
  Matrix T = Matrix::Identity();
  T(k_table_at, k_table_at + 1) = k_slope * shift.x() / k_height_mm;
  T(k_table_at, k_table_at + 2) = k_slope * shift.y() / k_height_mm;
  TableEvidence counted = *this;
  counted.information = T.transpose() * information * T;
  Vector moved = Vector::Zero();
  const double height_there_mm =
      -plane.above_mm({usual.middle.x(), usual.middle.y(), 0});  // of this plane at the usual one's middle
  moved[k_table_at] = (height_there_mm - usual.height_mm) / k_height_mm;
  moved[k_table_at + 1] = (plane.slope_x - usual.slope_x) / k_slope;
  moved[k_table_at + 2] = (plane.slope_y - usual.slope_y) / k_slope;
  counted.pull = T.transpose() * pull + counted.information * moved;
  counted.plane = usual;
  return counted;
}

bool TableEvidence::is_another(const TablePlane& usual) const {
  const double apart_mm = usual.above_mm({plane.middle.x(), plane.middle.y(), plane.height_mm});
  return std::abs(apart_mm) > k_another_mm ||
         std::hypot(plane.slope_x - usual.slope_x, plane.slope_y - usual.slope_y) > k_most_slope / 10;
}

std::optional<TableEvidence> see_table(const ScanView& scan, const geometry::SensorModel& head) {
  const std::vector<Stretch> profiles = profiles_of(scan);
  const auto found = lowest_plane(scan, profiles);
  if (!found) return std::nullopt;
  std::vector<Stretch> stretches = stretches_on(*found, scan, profiles);
  if (2 * stretches.size() < profiles.size() || !goes_round(scan, stretches)) return std::nullopt;
  const auto plane = fitted(scan, stretches, *found);
  if (!plane) return std::nullopt;
  TableEvidence table{
      .plane = *plane, .scatter_mm = scatter_of(scan, stretches, *plane), .profiles = stretches.size()};
  const Motion motion{head};
  for (const Stretch& stretch : stretches) {
    const SE3& T_base_flange = scan.poses[stretch.frame].pose.T_base_flange;
    const SE3 T_cam_base = (T_base_flange * head.T_flange_cam).inverse(Eigen::Isometry);
    const std::size_t step = (stretch.points.size() - 1) / k_most_points + 1;
    // Errors of one profile go together: it counts as one observation.
    const double information = 1 / (table.scatter_mm * table.scatter_mm) * static_cast<double>(step) /
                               static_cast<double>(stretch.points.size());
    for (std::size_t k = 0; k < stretch.points.size(); k += step) {
      const Vec3 point = scan.points_base[stretch.points[k]].cast<double>();
      const Vec2 from_middle = point.head<2>() - plane->middle;
      Eigen::Matrix<double, 1, k_quantities> row =
          Eigen::RowVector3d{-plane->slope_x, -plane->slope_y, 1} *
          motion.of({.point_cam = T_cam_base * point,
                     .velocity_base_mm_s = velocity_mm_s(scan.poses, stretch.frame, point),
                     .R_base_flange = T_base_flange.linear()});
      row[k_table_at] = -k_table[k_table_at].si;
      row[k_table_at + 1] = -k_table[k_table_at + 1].si * from_middle.x();
      row[k_table_at + 2] = -k_table[k_table_at + 2].si * from_middle.y();
      const double above_mm = plane->above_mm(point);
      const double weight = information * weight_of(above_mm);
      if (!row.allFinite()) continue;
      table.information += weight * row.transpose() * row;
      table.pull -= weight * above_mm * row.transpose();
    }
  }
  return table;
}

}  // namespace biteline::drift
