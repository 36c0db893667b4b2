// SPDX-License-Identifier: MIT
#include "host/calibration/laser/laser_calibration.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

#include "host/calibration/camera/plane_pose.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::calibration {

namespace {

constexpr int k_least_views = 3;          ///< two cannot show that one of them is wrong
constexpr int k_least_stripe_points = 5;  ///< thinned, on one view
/// The stripe's points are good to some 0.01 mm; 0.3 mm is a fault and not noise on any head of working
/// distance 0.1 to 0.5 m.
constexpr double k_ransac_reach_mm = 0.3;
constexpr double k_most_rms_mm = 0.3;
/// A view this far off (as pixels at its distance), and 5 times as far as the others, saw something else.
constexpr double k_view_outlier_px = 1, k_view_outlier_ratio = 5;
/// Rings of a grid under a wrong camera or on a bent target.
constexpr double k_most_ring_rms_px = 1.0;
/// Two grids of one rigid target, as single views show them.
constexpr double k_rigid_mm = 3.0;

struct Located {
  std::size_t view;
  std::size_t point;
  Vec3 point_cam;
};

/// Ray through a pixel, cut with the target's plane.  In the target's frame, and in cam.
struct Cut {
  Vec3 point_target, point_cam;
};
std::optional<Cut> cut_plane(const geometry::Camera& camera, const SE3& T_cam_plane, const Vec2& pixel_px) {
  const Vec3 ray = camera.ray(pixel_px), normal = T_cam_plane.linear().col(2);
  const double along = ray.dot(normal);
  if (std::abs(along) < 1e-3 * ray.norm()) return std::nullopt;
  const Vec3 point_cam = ray * (T_cam_plane.translation().dot(normal) / along);
  if (point_cam.z() <= 0) return std::nullopt;
  return Cut{.point_target = T_cam_plane.inverse() * point_cam, .point_cam = point_cam};
}

/// Within the grid and half a pitch beyond: there the target is certainly plane.
bool on_grid(const RingTarget& target, const Vec3& point_target) {
  const double margin_mm = 0.5 * target.pitch_mm;
  return point_target.x() > -margin_mm && point_target.y() > -margin_mm &&
         point_target.x() < (target.cols - 1) * target.pitch_mm + margin_mm &&
         point_target.y() < (target.rows - 1) * target.pitch_mm + margin_mm;
}

void assign_points(const geometry::Camera& camera, LaserView& view) {
  for (const StripePoint& seen : view.pictures.stripe) {
    int plane = -1, hits = 0;
    for (std::size_t k = 0; k < view.T_cam_plane.size(); ++k) {
      const auto cut = cut_plane(camera, view.T_cam_plane[k], seen.pixel_px);
      if (!cut || !on_grid(view.pictures.planes[k].target, cut->point_target)) continue;
      plane = static_cast<int>(k);
      ++hits;
    }
    if (hits == 1) view.points.push_back({.seen = seen, .plane = plane});
  }
}

std::vector<Located> locate(const geometry::Camera& camera, const std::vector<LaserView>& views) {
  std::vector<Located> points;
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (std::size_t i = 0; i < views[v].points.size(); ++i) {
      const PlaneStripePoint& p = views[v].points[i];
      const auto cut =
          cut_plane(camera, views[v].T_cam_plane[static_cast<std::size_t>(p.plane)], p.seen.pixel_px);
      if (cut) points.push_back({.view = v, .point = i, .point_cam = cut->point_cam});
    }
  }
  return points;
}

/// The plane through three points that most points agree on.
geometry::LaserPlane consensus_plane(const std::vector<Located>& points) {
  std::mt19937_64 random{1};
  std::uniform_int_distribution<std::size_t> any(0, points.size() - 1);
  geometry::LaserPlane best;
  double best_cost = std::numeric_limits<double>::max();
  constexpr int k_draws = 400;  // half of the points bad: 1 - (1 - 0.125)^400, certain
  for (int draw = 0; draw < k_draws; ++draw) {
    const Vec3 a = points[any(random)].point_cam, b = points[any(random)].point_cam,
               c = points[any(random)].point_cam;
    const Vec3 normal = (b - a).cross(c - a);
    if (normal.norm() < 1e-2 * (b - a).norm() * (c - a).norm() || normal.norm() < 1e-9) continue;
    const geometry::LaserPlane plane{.normal_cam = normal.normalized(),
                                     .distance_mm = normal.normalized().dot(a)};
    double cost = 0;
    for (const Located& p : points)
      cost +=
          std::min(std::pow(plane.signed_distance_mm(p.point_cam), 2), k_ransac_reach_mm * k_ransac_reach_mm);
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = plane;
  }
  return best;
}

std::vector<Vec3> near_points(const std::vector<Located>& points, const geometry::LaserPlane& plane,
                              double reach_mm) {
  std::vector<Vec3> result;
  for (const Located& p : points) {
    if (std::abs(plane.signed_distance_mm(p.point_cam)) <= reach_mm) result.push_back(p.point_cam);
  }
  return result;
}

/// Total least squares over the points within 4 robust standard deviations, to convergence.
LaserPlaneFit robust_plane(const std::vector<Located>& points, double& reach_mm) {
  geometry::LaserPlane plane = consensus_plane(points);
  LaserPlaneFit fit;
  for (int round = 0; round < 10; ++round) {
    std::vector<double> distances;
    for (const Located& p : points) distances.push_back(std::abs(plane.signed_distance_mm(p.point_cam)));
    reach_mm = std::max(0.01, 4 * geometry::k_sigma_per_mad * geometry::median_of(std::move(distances)));
    fit = fit_plane(near_points(points, plane, reach_mm));
    const double turn = fit.plane.normal_cam.cross(plane.normal_cam).norm();
    plane = fit.plane;
    if (turn < 1e-9) break;
  }
  return fit;
}

double rms_to(const geometry::LaserPlane& plane, const std::vector<Located>& points, std::size_t view) {
  std::vector<double> squares;
  for (const Located& p : points) {
    if (p.view == view) squares.push_back(std::pow(plane.signed_distance_mm(p.point_cam), 2));
  }
  if (squares.empty()) return 0;
  // Without the farthest tenth: single specks are no fault of the view.
  std::sort(squares.begin(), squares.end());
  const auto kept = static_cast<std::ptrdiff_t>(std::max<std::size_t>(1, squares.size() * 9 / 10));
  double sum = 0;
  for (auto it = squares.begin(); it != squares.begin() + kept; ++it) sum += *it;
  return std::sqrt(sum / static_cast<double>(kept));
}

double gap_mm(const SE3& T_a, const SE3& T_b) {
  constexpr double k_arm_mm = 50;  // a target's half size: turns an angle into what it moves
  return (T_a.translation() - T_b.translation()).norm() +
         k_arm_mm * geometry::angle_between_rad(T_a.linear(), T_b.linear());
}

/// Another reading of a grid: same picture, other numbers.
void renumber(PlaneView& view, SE3& T_cam_plane, const Reading& reading) {
  for (CentreObservation& c : view.centres) c.point_target = reading.T_this_other.inverse() * c.point_target;
  T_cam_plane = T_cam_plane * reading.T_this_other;
}

/// Orders and numbers both grids of every view as in the first one that shows both, by their rigid relation.
bool relate_planes(std::vector<LaserView>& views, SE3& T_plane1_plane2) {
  const auto both = [](const LaserView& view) { return view.T_cam_plane.size() == 2; };
  const auto first = std::find_if(views.begin(), views.end(), both);
  if (first == views.end()) return false;
  T_plane1_plane2 = first->T_cam_plane[0].inverse() * first->T_cam_plane[1];
  for (LaserView& view : views) {
    if (!both(view)) continue;
    double best_mm = std::numeric_limits<double>::max();
    bool best_swap = false;
    Reading best_a, best_b;
    for (const bool swap : {false, true}) {
      const std::size_t a = swap ? 1 : 0, b = 1 - a;
      for (const Reading& reading_a : view.pictures.planes[a].grid.readings) {
        for (const Reading& reading_b : view.pictures.planes[b].grid.readings) {
          const SE3 T_12 = (view.T_cam_plane[a] * reading_a.T_this_other).inverse() * view.T_cam_plane[b] *
                           reading_b.T_this_other;
          const double mm = gap_mm(T_12, T_plane1_plane2);
          if (mm >= best_mm) continue;
          best_mm = mm;
          best_swap = swap;
          best_a = reading_a;
          best_b = reading_b;
        }
      }
    }
    if (best_mm > k_rigid_mm) continue;
    if (best_swap) {
      std::swap(view.pictures.planes[0], view.pictures.planes[1]);
      std::swap(view.T_cam_plane[0], view.T_cam_plane[1]);
      for (PlaneStripePoint& p : view.points) p.plane = 1 - p.plane;
    }
    renumber(view.pictures.planes[0], view.T_cam_plane[0], best_a);
    renumber(view.pictures.planes[1], view.T_cam_plane[1], best_b);
    view.rigid = true;
  }
  return std::count_if(views.begin(), views.end(), [](const LaserView& view) { return view.rigid; }) > 1;
}

/// Poses of the grids and the stripe points on them; or why the view cannot be used.
std::optional<std::string> prepare(const geometry::Camera& camera, LaserView& view) {
  if (view.pictures.planes.empty()) return "no grid of its target.yaml found in the lit picture";
  if (view.pictures.stripe.empty()) return "no stripe in its laser picture";
  for (PlaneView& plane : view.pictures.planes) {
    const auto pose = fit_view_pose(camera, plane);
    if (!pose) return "the pose of a grid cannot be found";
    if (pose->rms_px > k_most_ring_rms_px) {
      char reason[160];
      std::snprintf(reason, sizeof reason,
                    "%s off by %.2f px under the camera's calibration (another camera?)",
                    plane.target.marks(), pose->rms_px);
      return reason;
    }
    view.T_cam_plane.push_back(pose->T_cam_target);
  }
  assign_points(camera, view);
  if (view.points.size() < static_cast<std::size_t>(k_least_stripe_points))
    return "the stripe does not cross a grid";
  return std::nullopt;
}

}  // namespace

LaserPlaneFit fit_plane(const std::vector<Vec3>& points) {
  LaserPlaneFit fit;
  if (points.empty()) return fit;
  for (const Vec3& p : points) fit.middle += p;
  fit.middle /= static_cast<double>(points.size());
  Mat3 scatter = Mat3::Zero();
  for (const Vec3& p : points) scatter += (p - fit.middle) * (p - fit.middle).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scatter / static_cast<double>(points.size()));
  fit.spread_mm = solver.eigenvalues().reverse().cwiseMax(0).cwiseSqrt();
  const Vec3 normal = solver.eigenvectors().col(0);
  const double distance_mm = normal.dot(fit.middle);
  const double side = distance_mm > 0 ? -1.0 : 1.0;
  fit.plane = {.normal_cam = side * normal, .distance_mm = side * distance_mm};
  return fit;
}

Result<LaserCalibration> calibrate_laser(const geometry::Camera& camera,
                                         std::vector<LaserPictures> pictures) {
  LaserCalibration result;
  const auto total = pictures.size();
  for (LaserPictures& one : pictures) {
    LaserView view;
    view.pictures = std::move(one);
    if (const auto reason = prepare(camera, view)) {
      result.set_aside.push_back({.name = view.pictures.name, .reason = *reason});
    } else {
      result.views.push_back(std::move(view));
    }
  }
  LaserPlaneFit fit;
  double reach_mm = 0;
  std::vector<Located> points;
  for (;;) {
    if (result.views.size() < static_cast<std::size_t>(k_least_views)) {
      const char* why = result.set_aside.empty() ? "" : result.set_aside.front().reason.c_str();
      return fail(Errc::Refused, "laser: %d of %d places usable, at least %d are needed%s%.120s",
                  static_cast<int>(result.views.size()), static_cast<int>(total), k_least_views,
                  *why != '\0' ? "; first fault: " : "", why);
    }
    points = locate(camera, result.views);
    fit = robust_plane(points, reach_mm);
    std::vector<double> rms_mm;
    for (std::size_t v = 0; v < result.views.size(); ++v) rms_mm.push_back(rms_to(fit.plane, points, v));
    std::vector<double> sorted = rms_mm;
    std::sort(sorted.begin(), sorted.end());
    const auto worst =
        static_cast<std::size_t>(std::max_element(rms_mm.begin(), rms_mm.end()) - rms_mm.begin());
    if (rms_mm[worst] < std::max(k_view_outlier_px * fit.middle.z() / camera.fv_px,
                                 k_view_outlier_ratio * sorted[sorted.size() / 2]))
      break;
    char reason[160];
    std::snprintf(reason, sizeof reason,
                  "its stripe lies %.2f mm off the plane of the others, they %.3f mm (target moved between "
                  "the pictures?)",
                  rms_mm[worst], sorted[sorted.size() / 2]);
    result.set_aside.push_back({.name = result.views[worst].pictures.name, .reason = reason});
    result.views.erase(result.views.begin() + static_cast<std::ptrdiff_t>(worst));
  }
  // Two nearly parallel stripes still span a plane; one line does not.
  if (fit.spread_mm[1] < 0.02 * fit.spread_mm[0] || fit.spread_mm[1] < 10 * fit.spread_mm[2]) {
    return fail(
        Errc::Degenerate,
        "laser: all stripe points lie on one line (%.1f x %.2f mm): move the target nearer and farther",
        fit.spread_mm[0], fit.spread_mm[1]);
  }
  if (fit.spread_mm[2] > k_most_rms_mm) {
    return fail(Errc::Refused,
                "laser: stripe points scatter %.2f mm about the plane, at most %.1f mm is a calibration",
                fit.spread_mm[2], k_most_rms_mm);
  }
  result.plane = fit.plane;
  result.middle_cam = fit.middle;
  std::vector<std::vector<PlaneStripePoint>> used(result.views.size());
  double sum = 0;
  for (const Located& p : points) {
    const double distance_mm = fit.plane.signed_distance_mm(p.point_cam);
    if (std::abs(distance_mm) > reach_mm) {
      ++result.points_set_aside;
      continue;
    }
    used[p.view].push_back(result.views[p.view].points[p.point]);
    sum += distance_mm * distance_mm;
    ++result.points;
  }
  result.rms_mm = std::sqrt(sum / std::max(1, result.points));
  for (std::size_t v = 0; v < result.views.size(); ++v) {
    result.views[v].rms_mm = rms_to(fit.plane, points, v);
    result.views[v].points = std::move(used[v]);
  }
  std::vector<double> contrasts;
  for (const LaserView& view : result.views)
    if (view.pictures.speckle_contrast) contrasts.push_back(*view.pictures.speckle_contrast);
  if (!contrasts.empty()) result.speckle_contrast = geometry::median_of(std::move(contrasts));
  result.two_planes = relate_planes(result.views, result.T_plane1_plane2);
  return result;
}

}  // namespace biteline::calibration
