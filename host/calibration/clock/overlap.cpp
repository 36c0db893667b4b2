// SPDX-License-Identifier: MIT
#include "host/calibration/clock/overlap.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

#include "common/geometry/pose_track.hpp"
#include "host/calibration/laser/laser_calibration.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

struct PointAdaptor {
  const std::vector<ScanPoint>& points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i].point_base[static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointAdaptor>,
                                                 PointAdaptor, 3, std::size_t>;

double seconds_between(const Scan& scan, std::uint32_t a, std::uint32_t b) {
  return std::abs(
      std::chrono::duration<double>(scan.frames[a].exposure_mid - scan.frames[b].exposure_mid).count());
}

constexpr std::size_t k_least_points = 10;  ///< 6 unknowns, and some to average the noise
/// Noise gain of the fit below the point: more, and the point lies at the neighbours' edge or these lie on
/// lines.
constexpr double k_most_gain = 0.7;

/// Fits z = a + b x + c y + d x^2 + e x y + f y^2 in the neighbours' plane, origin below the point; false
/// where they do not carry it.
bool fit_surface(const std::vector<ScanPoint>& points, OverlapPair& pair, double reach_mm) {
  std::vector<Vec3> places;
  for (const std::size_t i : pair.others) places.push_back(points[i].point_base);
  const LaserPlaneFit plane = fit_plane(places);
  // Neighbours on a line, or on both sides of a crease.
  if (plane.spread_mm[1] < 0.2 * reach_mm || plane.spread_mm[2] > 0.1 * reach_mm) return false;
  const Vec3 n = plane.plane.normal_cam;
  const Vec3 e1 = n.unitOrthogonal(), e2 = n.cross(e1);
  const Vec3& origin = points[pair.point].point_base;
  Eigen::Matrix<double, Eigen::Dynamic, 6> A(static_cast<Eigen::Index>(places.size()), 6);
  Eigen::VectorXd z(static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3 d = (places[i] - origin) / reach_mm;
    const double x = d.dot(e1), y = d.dot(e2);
    A.row(static_cast<Eigen::Index>(i)) << 1, x, y, x * x, x * y, y * y;
    z[static_cast<Eigen::Index>(i)] = d.dot(n);
  }
  const Eigen::Matrix<double, 6, 6> normal_matrix = A.transpose() * A;
  const geometry::SymmetricSolver solver{normal_matrix};
  const Eigen::Matrix<double, 6, 1> first = solver.solve(Eigen::VectorXd::Unit(6, 0));
  const Eigen::VectorXd weights = A * first;
  if (!solver.sound() || !weights.allFinite() || weights.squaredNorm() > k_most_gain) return false;
  const Eigen::Matrix<double, 6, 1> a = solver.solve(A.transpose() * z);
  pair.weights.assign(weights.data(), weights.data() + weights.size());
  pair.normal = (n - a[1] * e1 - a[2] * e2).normalized();
  pair.distance_mm = -a[0] * reach_mm * pair.normal.dot(n);
  return true;
}

}  // namespace

std::vector<ScanPoint> place_points(const Scan& scan, const ScanModel& model) {
  std::vector<geometry::PoseSample> samples;
  samples.reserve(scan.poses.size());
  for (const session::StampedPose& pose : scan.poses) {
    samples.push_back(
        {.stamp = to_sensor_clock(pose.stamp, model.pose_clock_offset), .T_base_flange = pose.T_base_flange});
  }
  std::vector<std::vector<ScanPoint>> placed(scan.frames.size());
  tbb::parallel_for(std::size_t{0}, scan.frames.size(), [&](std::size_t f) {
    geometry::PoseEstimate pose;
    if (!geometry::rt_pose_at(samples, scan.frames[f].exposure_mid, {}, pose) || pose.stale ||
        pose.extrapolated)
      return;
    for (std::size_t i = 0; i < scan.frames[f].stripe_px.size(); ++i) {
      const Vec3 point_cam = geometry::triangulate(model.camera, model.plane, scan.frames[f].stripe_px[i]);
      if (!(point_cam.z() > 0)) continue;
      const Vec3 point_flange = model.T_flange_cam * point_cam;
      const Vec3 velocity_flange =
          pose.velocity_per_s.head<3>() + pose.velocity_per_s.tail<3>().cross(point_flange);
      placed[f].push_back({.point_base = pose.T_base_flange * point_flange,
                           .point_cam = point_cam,
                           .velocity_base_mm_s = pose.T_base_flange.linear() * velocity_flange,
                           .frame = static_cast<std::uint32_t>(f),
                           .pixel = static_cast<std::uint32_t>(i)});
    }
  });
  std::vector<ScanPoint> points;
  for (const auto& part : placed) points.insert(points.end(), part.begin(), part.end());
  return points;
}

std::vector<OverlapPair> find_overlaps(const Scan& scan, const std::vector<ScanPoint>& points,
                                       const OverlapSearch& search) {
  const PointAdaptor adaptor{points};
  Tree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  tree.buildIndex();
  std::vector<OverlapPair> found(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    std::vector<std::pair<std::size_t, double>> near;
    tree.radiusSearch(points[i].point_base.data(), search.reach_mm * search.reach_mm, near,
                      nanoflann::SearchParams());
    // The pass of the nearest point that is far enough away in time.
    const auto other = std::find_if(near.begin(), near.end(), [&](const auto& n) {
      return seconds_between(scan, points[n.first].frame, points[i].frame) > search.least_gap_s;
    });
    if (other == near.end()) return;
    const std::uint32_t pass = points[other->first].frame;
    OverlapPair pair{.point = i, .others = {}, .weights = {}, .normal = Vec3::UnitZ(), .distance_mm = 0};
    for (const auto& n : near) {
      if (seconds_between(scan, points[n.first].frame, pass) <= search.least_gap_s / 2)
        pair.others.push_back(n.first);
    }
    if (pair.others.size() < k_least_points || !fit_surface(points, pair, search.reach_mm)) return;
    found[i] = std::move(pair);
  });
  std::erase_if(found, [](const OverlapPair& pair) { return pair.others.empty(); });
  return found;
}

}  // namespace biteline::calibration
