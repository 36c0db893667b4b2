// SPDX-License-Identifier: MIT
#include "host/calibration/drift/seen_twice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "host/geometry/robust.hpp"

namespace biteline::drift {
namespace {

constexpr double k_spacing_mm = 0.8;
constexpr float k_cell_mm = 8;

std::uint64_t cell_of(const Eigen::Vector3f& point) {
  std::uint64_t key = 0;
  for (const float value : point) {
    const auto at = static_cast<std::int64_t>(std::floor(value / k_cell_mm));
    key = key * 2'097'152 + static_cast<std::uint64_t>(at + 1'048'576);
  }
  return key;
}

/// First and last sight of a cell.
struct Sights {
  double first_s{std::numeric_limits<double>::infinity()};
  double last_s{-std::numeric_limits<double>::infinity()};
};

/// Between profiles, where they lie: half of them are nearer.
double profile_spacing_mm(const std::vector<calibration::ScanPoint>& points) {
  std::vector<double> apart_mm;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i].frame == points[i - 1].frame + 1) {
      // From the last point of one to the plane of the next: by the way that the flange goes.
      apart_mm.push_back(points[i].velocity_base_mm_s.norm());
    }
  }
  return apart_mm.empty() ? 0 : geometry::median_of(std::move(apart_mm));
}

}  // namespace

SeenTwice seen_twice(const ScanView& scan, const geometry::SensorModel& head) {
  SeenTwice seen;
  const std::vector<std::uint32_t> frames = frames_of(scan);
  std::unordered_map<std::uint64_t, Sights> cells;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i] == k_no_frame) continue;
    Sights& sights = cells[cell_of(scan.points_base[i])];
    const double time_s = scan.poses[frames[i]].pose.time_s;
    sights.first_s = std::min(sights.first_s, time_s);
    sights.last_s = std::max(sights.last_s, time_s);
  }
  Vec3 last{Vec3::Constant(std::numeric_limits<double>::infinity())};
  std::uint32_t last_frame = k_no_frame;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i] == k_no_frame) continue;
    const Sights& sights = cells[cell_of(scan.points_base[i])];
    if (!(sights.last_s - sights.first_s > k_least_gap_s)) continue;
    const Vec3 point = scan.points_base[i].cast<double>();
    if (frames[i] == last_frame && (point - last).norm() < k_spacing_mm) continue;
    const SE3 T_base_cam = scan.poses[frames[i]].pose.T_base_flange * head.T_flange_cam;
    const Vec3 point_cam = T_base_cam.inverse() * point;
    if (!(point_cam.z() > 1)) continue;
    last = point;
    last_frame = frames[i];
    seen.points.push_back({.point_base = point,
                           .point_cam = point_cam,
                           .velocity_base_mm_s = velocity_mm_s(scan.poses, frames[i], point),
                           .frame = frames[i],
                           .pixel = static_cast<std::uint32_t>(i)});
  }
  const double begin_s = scan.poses.empty() ? 0 : scan.poses.front().pose.time_s;
  for (const PosedProfile& posed : scan.poses) {
    // From the scan's begin: a clock's own count may be too large for a double's microseconds.
    const auto since = Nanoseconds{std::llround(1e9 * (posed.pose.time_s - begin_s))};
    seen.times.frames.push_back({.exposure_mid = SensorClock::time_point{since}, .stripe_px = {}});
    seen.rotation.push_back(posed.pose.T_base_flange.linear());
  }
  if (scan.poses.size() > 1) {
    const double frame_s =
        (scan.poses.back().pose.time_s - begin_s) / static_cast<double>(scan.poses.size() - 1);
    // Three profiles of the other view on either side carry a bent surface.
    seen.reach_mm = std::clamp(1.7 * frame_s * profile_spacing_mm(seen.points), 2.0, 6.0);
  }
  return seen;
}

}  // namespace biteline::drift
